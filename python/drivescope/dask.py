"""Campaigns on several machines, through `dask.distributed`.

    from dask.distributed import Client
    import drivescope.dask

    with Client("tcp://scheduler:8786") as client:
        done = drivescope.dask.campaign("plan.toml", "results", client)
    done.to_pandas()

Scenarios go out in batches of about a second. Each batch is stored in the folder as it arrives,
under a name that tells its scenarios, so that with `resume=True` what is there is not run again:
after the loss of workers, scheduler or this process. Every worker must have the version of
drivescope that drives the campaign; it is sent plan, drive, FMU and detectors, and compares their
digest. A scenario that ends the process which runs it is found, run once more in a process of its
own, and stands in the results as `aborted`; those of a foreign FMU always run in processes of their
own. The dataset is, byte for byte, that of `campaign` on one machine.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import cloudpickle
from distributed import Client, Future, KilledWorker, as_completed, get_client
from distributed.client import FutureCancelledError
from distributed.comm import CommClosedError

from . import _drivescope
from ._progress import Progress, ProgressFunction, shown

if TYPE_CHECKING:
    import pandas as pd

#: How long a batch is to take, s.
BATCH_S = 1.0
#: Scenarios of the first batches, which tell how long one takes.
PILOT = 16
#: Batches on their way for each thread of the cluster: one runs, one waits.
AHEAD = 2
#: How often it is looked for a batch that has arrived, s.
LOOK_S = 0.02


class Unfinished(RuntimeError):
    """The cluster was lost before the end; what was done until then is stored."""


@dataclass(frozen=True)
class Done:
    """A campaign that has come to its end."""

    #: The dataset: one row a scenario.
    dataset: Path
    #: How many scenarios it holds.
    scenarios: int
    #: Those that ended the process which ran them.
    aborted: tuple[int, ...]

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a scenario."""
        import pandas

        return pandas.read_parquet(self.dataset)


@dataclass(frozen=True)
class Work:
    """What is sent to a worker."""

    version: str
    digest: str
    plan: str
    design: str
    #: Files beside the plan, with their content: its drive and its FMU, where it has them there.
    files: tuple[tuple[str, bytes], ...]


@dataclass(frozen=True)
class Made:
    """What comes of some scenarios."""

    #: The content of their file.
    rows: bytes
    #: Signals of a foreign FMU that are kept: names of files and their content.
    traces: tuple[tuple[str, bytes], ...] = ()


#: Runs some scenarios.
Runner = Callable[[Work, int, int], Made]


class _Here:
    """The campaign of a worker, in a folder that goes with it."""

    def __init__(self, work: Work) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix=".drivescope-")
        folder = Path(self._folder.name)
        for name, content in work.files:
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        plan = folder / ".plan.toml"
        plan.write_text(work.plan, encoding="utf-8", newline="")
        results = folder / ".results"
        self.scenarios = _drivescope.Scenarios.in_folder(plan, results, work.design)


@lru_cache(maxsize=4)
def _here(work: Work) -> _Here:
    """Return the campaign of a worker, made once in a process."""
    here = f"worker {platform.node()} (process {os.getpid()})"
    if work.version != _drivescope.__version__:
        raise _drivescope.Error(
            f"{here} has drivescope {_drivescope.__version__}, the campaign is driven by "
            f"{work.version}\ninstall the same version on every machine, and restart the workers"
        )
    made = _Here(work)
    if made.scenarios.digest != work.digest:
        raise _drivescope.Error(
            f"{here} reads another campaign out of the same plan: {made.scenarios.digest}, not "
            f"{work.digest}\ninstall the same build of drivescope on every machine"
        )
    return made


def _taken(path: Path) -> bytes:
    content = path.read_bytes()
    path.unlink()
    return content


def _made(write: Callable[[Path], list[Path]]) -> Made:
    """Read what is written: a part, and the traces whose paths are returned."""
    with tempfile.TemporaryDirectory(prefix=".drivescope-") as folder:
        path = Path(folder) / "part.parquet"
        traces = write(path)
        return Made(path.read_bytes(), tuple((it.name, _taken(it)) for it in traces))


def run(work: Work, first: int, end: int) -> Made:
    """Run scenarios on this worker."""
    scenarios = _here(work).scenarios
    return _made(lambda path: scenarios.run(first, end, path))


def _aborted_alone(work: Work, scenario: int) -> Made:
    def write(path: Path) -> list[Path]:
        _here(work).scenarios.aborted(scenario, path)
        return []

    return _made(write)


@dataclass(frozen=True)
class _Part:
    """What came of some scenarios."""

    first: int
    end: int
    made: Made
    aborted: bool


def _batch(runner: Runner, work: Work, first: int, end: int) -> tuple[list[_Part], float]:
    _here(work)
    began = time.monotonic()
    made = runner(work, first, end)
    return [_Part(first, end, made, False)], time.monotonic() - began


def _isolated(runner: Runner, work: Work, first: int, end: int) -> list[_Part]:
    """Run scenarios in processes of their own, halved until what ends a process stands alone."""
    task = cloudpickle.dumps((runner, work, first, end))
    child = [sys.executable, "-m", "drivescope._isolated"]
    ran = subprocess.run(child, input=task, capture_output=True, check=False)
    if ran.returncode == 0:
        return [_Part(first, end, cloudpickle.loads(ran.stdout), False)]
    if ran.returncode > 0:
        # It ended in good order: an error that every process would meet.
        raise RuntimeError(f"scenarios {first} to {end - 1}: {ran.stderr.decode(errors='replace')}")
    if end - first == 1:
        return [_Part(first, end, _aborted_alone(work, first), True)]
    middle = (first + end) // 2
    return _isolated(runner, work, first, middle) + _isolated(runner, work, middle, end)


def _alone(runner: Runner, work: Work, first: int, end: int) -> tuple[list[_Part], None]:
    return _isolated(runner, work, first, end), None


def _same(work: Work) -> Work:
    return work


class _Batches:
    """Ranges that are to be run, cut to what takes about a second."""

    def __init__(self, missing: list[tuple[int, int]], batch_s: float) -> None:
        self._missing = missing[::-1]
        self._batch_s = batch_s
        self._size = PILOT

    def took(self, scenarios: int, seconds: float) -> None:
        """Learn from a batch; no more than four times as many at once."""
        wanted = int(scenarios * self._batch_s / max(seconds, 1e-3))
        self._size = max(1, min(wanted, 4 * self._size))

    def __iter__(self) -> Iterator[tuple[int, int]]:
        while self._missing:
            first, end = self._missing.pop()
            cut = min(first + self._size, end)
            if cut < end:
                self._missing.append((cut, end))
            yield first, cut


def campaign(
    plan: str | os.PathLike[str],
    output: str | os.PathLike[str],
    client: Client | None = None,
    *,
    resume: bool = False,
    batch_s: float = BATCH_S,
    progress: Progress = None,
    runner: Runner = run,
) -> Done:
    """Run the scenarios of a plan file on a cluster, into a folder.

    `runner` runs some scenarios on a worker; a test may give another. Raises `drivescope.Error` for
    a plan or a folder that cannot be used and for a worker of another version, and `Unfinished`
    where the cluster is lost: run it again with `resume`.
    """
    client = client or get_client()
    output = Path(output)
    scenarios = _drivescope.Scenarios.in_folder(plan, output)
    look, end_of_progress = shown(progress)
    try:
        missing = _missing(scenarios, output, resume)
        work = Work(
            version=_drivescope.__version__,
            digest=scenarios.digest,
            plan=scenarios.plan,
            design=scenarios.design,
            files=_files(Path(plan), scenarios.drive_name, scenarios.fmu_name),
        )
        _Cluster(client, work, runner, scenarios, output, look).run(missing, batch_s)
        dataset = Path(_drivescope.merged(output))
        return Done(dataset, scenarios.count, _aborted(dataset))
    finally:
        end_of_progress()
        scenarios.release()


def _files(plan: Path, *names: str | None) -> tuple[tuple[str, bytes], ...]:
    """Return names and content of those files that lie beside the plan."""
    # What is named by its whole path is looked for there on every machine.
    beside = [it for it in names if it and not os.path.isabs(it) and ".." not in Path(it).parts]
    files = ((name, plan.parent / name) for name in beside)
    return tuple((name, file.read_bytes()) for name, file in files if file.is_file())


def _missing(scenarios: _drivescope.Scenarios, folder: Path, resume: bool) -> list[tuple[int, int]]:
    missing, damaged = scenarios.missing(folder)
    whole = missing == [(0, scenarios.count)] and not damaged
    if not whole and not resume:
        left = sum(end - first for first, end in missing)
        raise _drivescope.Error(
            f"{folder}: {scenarios.count - left} of {scenarios.count} scenarios are there already\n"
            "go on with resume=True, or choose another folder"
        )
    for path, _ in damaged:
        # A part that was cut short, by a full disk for one, is run again.
        Path(path).unlink()
    return missing


def _aborted(dataset: Path) -> tuple[int, ...]:
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(dataset, columns=["scenario", "status"]).to_pydict()
    pairs = zip(table["scenario"], table["status"], strict=True)
    return tuple(scenario for scenario, status in pairs if status == "aborted")


def _store(folder: Path, name: str, content: bytes) -> None:
    """Put a file in place, whole or not at all."""
    folder.mkdir(exist_ok=True)
    handle, temporary = tempfile.mkstemp(prefix=".drivescope-", dir=folder)
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(content)
            out.flush()
            os.fsync(out.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, folder / name)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


class _Cluster:
    """Keeps the workers of a cluster busy, and stores what they send."""

    def __init__(
        self,
        client: Client,
        work: Work,
        runner: Runner,
        scenarios: _drivescope.Scenarios,
        folder: Path,
        look: ProgressFunction | None,
    ) -> None:
        self._client = client
        self._key = f"drivescope-{work.digest}"
        self._given = work
        self._runner = runner
        self._scenarios = scenarios
        self._folder = folder
        self._look = look
        self._done = 0

    def _submit(self, job: Callable[..., object], batch: tuple[int, int], kind: str) -> Future:
        key = f"{self._key}-{kind}-{batch[0]}-{batch[1]}"
        # Not to be mistaken for a pure function: a batch that was lost is to be run again.
        return self._client.submit(job, self._runner, self._work, *batch, key=key)

    def run(self, missing: list[tuple[int, int]], batch_s: float) -> None:
        """Run what is missing; each batch is stored as it arrives."""
        self._done = self._scenarios.count - sum(end - first for first, end in missing)
        try:
            # A task, and no scattered data: it is made again where a worker that held it is lost.
            self._work = self._client.submit(_same, self._given, key=f"{self._key}-work")
            self._drive(_Batches(missing, batch_s))
        except (CancelledError, FutureCancelledError, CommClosedError, TimeoutError) as lost:
            count = self._scenarios.count
            raise Unfinished(
                f"the cluster was lost: {self._done} of {count} scenarios are stored in "
                f"{self._folder}\nrun it again with resume=True"
            ) from lost

    def _drive(self, batches: _Batches) -> None:
        coming = iter(batches)
        running: dict[Future, tuple[int, int]] = {}
        arriving = as_completed()
        try:
            while True:
                while len(running) < AHEAD * self._threads():
                    batch = next(coming, None)
                    if batch is None:
                        break
                    running[future := self._submit(_batch, batch, "batch")] = batch
                    arriving.add(future)
                if not running:
                    return
                future = self._next(arriving)
                batch = running.pop(future)
                try:
                    parts, seconds = future.result()
                except KilledWorker:
                    # One of the batches on the workers that died: this one by itself, carefully.
                    running[future := self._submit(_alone, batch, "alone")] = batch
                    arriving.add(future)
                    continue
                self._take(parts)
                if seconds is not None:
                    batches.took(batch[1] - batch[0], seconds)
        finally:
            # What still runs for nobody is not to be waited for.
            for future in running:
                future.release()

    def _threads(self) -> int:
        try:
            return max(1, sum(self._client.nthreads().values()))
        except OSError as error:
            raise CommClosedError("the scheduler is gone") from error

    def _next(self, arriving: as_completed) -> Future:
        """Wait for the next batch, or find that there is nobody left to wait for."""
        while True:
            ready = arriving.next_batch(block=False)
            if ready:
                first, *others = ready
                for other in others:
                    arriving.add(other)
                return first
            if self._client.status != "running":
                raise CommClosedError("the scheduler is gone")
            time.sleep(LOOK_S)

    def _take(self, parts: list[_Part]) -> None:
        for part in parts:
            if self._scenarios.fmu_name is None:
                aborted = [part.first] if part.aborted else []
                self._scenarios.write_traces(self._folder, part.first, part.end, aborted)
            for name, content in part.made.traces:
                _store(self._folder / "traces", name, content)
            _store(self._folder, _drivescope.part(part.first, part.end), part.made.rows)
            self._done += part.end - part.first
        if self._look is not None:
            self._look("campaign", self._done, self._scenarios.count)
