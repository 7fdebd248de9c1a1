"""The commands as functions."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar

from . import _drivescope, _results
from ._drive import Diagnoser, Drive
from ._progress import Progress, shown
from ._recording import Recording

PathName = str | os.PathLike[str]
#: A drive: a built-in one by its name, a drive file, or a `Drive`.
AnyDrive = PathName | Drive
#: A recording: a file, a `Recording`, or what a `Recording` is made of.
AnyRecording = PathName | Recording | Any
#: One recording or several.
Recordings = AnyRecording | Sequence[AnyRecording]

A = TypeVar("A", bound=_results.Answer)


class _Call:
    """A command line that is put together, and what goes with it."""

    def __init__(self, command: str, scratch: str) -> None:
        self._options = [command]
        self._words: list[str] = []
        self._recordings: dict[str, Recording] = {}
        self._scratch = Path(scratch)

    def option(self, name: str, value: object) -> None:
        """Add an option, unless nothing is said."""
        if value is True:
            self._options.append(f"--{name}")
        elif value is not None and value is not False:
            text = os.fspath(value) if isinstance(value, os.PathLike) else value
            self._options.append(f"--{name}={text}")

    def options(self, name: str, values: Iterable[object]) -> None:
        """Add an option for each value."""
        for value in values:
            self.option(name, value)

    def word(self, word: str) -> None:
        """Add an argument without a name."""
        self._words.append(word)

    def scratch(self, name: str) -> Path:
        """Return a path for what the user names no file for."""
        return self._scratch / name

    def text(self, given: PathName | Drive | Diagnoser) -> str:
        """Return the word for a drive or a diagnoser."""
        if isinstance(given, (Drive, Diagnoser)):
            path = self.scratch(Path(given.source).with_suffix(".toml").name)
            path.write_text(given.text, encoding="utf-8", newline="")
            return os.fspath(path)
        return os.fspath(given)

    def recording(self, given: AnyRecording) -> str:
        """Return the word for a recording."""
        if isinstance(given, (str, os.PathLike)):
            if os.fspath(given) == "-":
                raise _drivescope.Error("`-` is standard input, which is the command line's alone")
            return os.fspath(given)
        if not isinstance(given, Recording):
            given = Recording(given, name=f"recording {len(self._recordings) + 1}")
        name, number = given.name, 1
        while self._recordings.get(name, given) is not given:
            number += 1
            name = f"{given.name} ({number})"
        self._recordings[name] = given
        return name

    def recordings(self, given: Recordings) -> list[str]:
        """Return the words for one recording or several."""
        many = isinstance(given, Sequence) and not isinstance(given, str)
        return [self.recording(it) for it in (given if many else [given])]

    def run(self, kind: type[A], progress: Progress) -> tuple[A, dict[str, _drivescope.Recording]]:
        """Run it; the answer, and the recordings that no file was named for."""
        look, end = shown(progress)
        recordings = [(name, it._held) for name, it in self._recordings.items()]
        arguments = [*self._options, "--", *self._words] if self._words else self._options
        try:
            done = _drivescope.call(arguments, recordings, os.fspath(self._scratch), look)
        finally:
            end()
        back = {os.fspath(path): it for path, it in done.recordings.items()}
        return kind(done.text, done.json, done.remarks), back


def _scratch() -> tempfile.TemporaryDirectory[str]:
    # What a call that was abandoned still has in it goes with the call.
    return tempfile.TemporaryDirectory(prefix=".drivescope-", ignore_cleanup_errors=True)


def _drive_at(path: PathName, source: str) -> Drive:
    return Drive.parse(Path(path).read_text(encoding="utf-8"), source)


def simulate(
    drive: AnyDrive,
    *,
    output: PathName | None = None,
    measured: AnyRecording | None = None,
    reference: str | None = None,
    input: str | None = None,
    duration: float | None = None,
    load: str | None = None,
    fault: str | Iterable[str] = (),
    period: float | None = None,
    noise: bool = True,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Simulation:
    """Run the model of a drive, or drive it with a recording.

    `reference`, `input` and `load` are laws in t, `duration` and `period` are s, a fault is such as
    `tacho=5%@2..3:ramp=0.5`.
    """
    with _scratch() as scratch:
        call = _Call("simulate", scratch)
        path = output or call.scratch("simulated.csv")
        call.option("output", path)
        call.option("measured", None if measured is None else call.recording(measured))
        call.option("reference", reference)
        call.option("input", input)
        call.option("duration", duration)
        call.option("load", load)
        call.options("fault", [fault] if isinstance(fault, str) else fault)
        call.option("period", period)
        call.option("noise", None if noise else "off")
        call.option("seed", seed)
        call.word(call.text(drive))
        answer, back = call.run(_results.Simulation, progress)
    if output is None:
        answer.recording = Recording._of(back[os.fspath(path)])
    else:
        answer.recording = Recording.read(output)
    return answer


def compare(
    drive: AnyDrive,
    recordings: Recordings,
    *,
    validate: Recordings = (),
    noise: Mapping[str, float] | None = None,
    out: PathName | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Comparison:
    """Compare a drive's model with recordings: how well it fits, where and when it fails.

    `noise` gives standard deviations of the sensors, SI: `{"i": 0.01}`.
    """
    with _scratch() as scratch:
        call = _Call("compare", scratch)
        report = _evidence(call, recordings, validate, noise, out, seed, [call.text(drive)])
        answer, _ = call.run(_results.Comparison, progress)
        answer.report = report.read_text(encoding="utf-8")
    return answer


def fit(
    drive: AnyDrive,
    recordings: Recordings,
    *,
    validate: Recordings = (),
    noise: Mapping[str, float] | None = None,
    output: PathName | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Fit:
    """Estimate the parameters of a drive from recordings, with standard errors."""
    with _scratch() as scratch:
        call = _Call("fit", scratch)
        path = output or call.scratch("fitted.toml")
        call.option("output", path)
        _evidence(call, recordings, validate, noise, None, seed, [call.text(drive)], report=False)
        answer, _ = call.run(_results.Fit, progress)
        answer.drive = _drive_at(path, os.fspath(output or "fitted.toml"))
    return answer


def discover(
    drive: AnyDrive,
    recordings: Recordings,
    *,
    validate: Recordings = (),
    noise: Mapping[str, float] | None = None,
    output: PathName | None = None,
    out: PathName | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Discovery:
    """Find what a drive's model lacks and add it, or answer that nothing, or nothing known, is."""
    return _search("discover", [drive], recordings, validate, noise, output, out, seed, progress)


def add(
    drive: AnyDrive,
    effect: str,
    recordings: Recordings,
    *,
    validate: Recordings = (),
    noise: Mapping[str, float] | None = None,
    output: PathName | None = None,
    out: PathName | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Discovery:
    """Add one effect to a drive, fit everything, and tell the error before and after."""
    words = [drive, effect]
    return _search("add", words, recordings, validate, noise, output, out, seed, progress)


def _search(
    command: str,
    given: Sequence[Any],
    recordings: Recordings,
    validate: Recordings,
    noise: Mapping[str, float] | None,
    output: PathName | None,
    out: PathName | None,
    seed: int | None,
    progress: Progress,
) -> _results.Discovery:
    with _scratch() as scratch:
        call = _Call(command, scratch)
        path = Path(output or call.scratch("found.toml"))
        call.option("output", path)
        words = [call.text(given[0]), *given[1:]]
        report = _evidence(call, recordings, validate, noise, out, seed, words)
        answer, _ = call.run(_results.Discovery, progress)
        answer.report = report.read_text(encoding="utf-8")
        judged = answer["verdict"] != "not_judged"
        answer.drive = _drive_at(path, os.fspath(output or "found.toml")) if judged else None
    return answer


def _evidence(
    call: _Call,
    recordings: Recordings,
    validate: Recordings,
    noise: Mapping[str, float] | None,
    out: PathName | None,
    seed: int | None,
    words: Iterable[str],
    report: bool = True,
) -> Path:
    """Add what commands on measured recordings share; where the report will be."""
    at = Path(out or call.scratch("report.html"))
    if report:
        call.option("out", at)
    call.options("validate", call.recordings(validate))
    if noise is not None:
        call.option("noise", ",".join(f"{name}={sd!r}" for name, sd in noise.items()))
    call.option("seed", seed)
    for word in [*words, *call.recordings(recordings)]:
        call.word(word)
    return at


def study(
    *,
    drive: AnyDrive = "dr300",
    out: PathName | None = None,
    torque: Literal["flux", "torque_constant", "actuator", "load"] | None = None,
    beta: float | None = None,
    profile: str | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Study:
    """Run the whole experiment: twelve faults through the exported FMU, with tables and a report.

    `out` is a folder for report, FMUs and runs.
    """
    with _scratch() as scratch:
        call = _Call("study", scratch)
        folder = Path(out or call.scratch("study"))
        call.option("out", folder)
        call.option("drive", call.text(drive))
        call.option("torque", torque)
        call.option("beta", beta)
        call.option("profile", profile)
        call.option("seed", seed)
        answer, _ = call.run(_results.Study, progress)
        answer.report = (folder / "report.html").read_text(encoding="utf-8")
    return answer


def train(
    healthy: Recordings,
    *,
    drive: AnyDrive | None = None,
    arl0: float | None = None,
    verify: int | None = None,
    excited: Recordings = (),
    fault: Mapping[str, Recordings] | None = None,
    input: Sequence[str] = (),
    output_signal: str | None = None,
    beta: float | None = None,
    window: float | None = None,
    run_up: float | None = None,
    without: Sequence[Literal["recurrent", "gmdh"]] = (),
    output: PathName | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Training:
    """Train a diagnoser on healthy recordings; `fault` has recordings of faults by their names."""
    with _scratch() as scratch:
        call = _Call("train", scratch)
        path = output or call.scratch("diagnoser.toml")
        call.option("output", path)
        call.option("drive", None if drive is None else call.text(drive))
        call.option("arl0", arl0)
        call.option("verify", verify)
        call.options("excited", call.recordings(excited))
        for name, recordings in (fault or {}).items():
            call.options("fault", [f"{name}={it}" for it in call.recordings(recordings)])
        call.option("input", ",".join(input) or None)
        call.option("output-signal", output_signal)
        call.option("beta", beta)
        call.option("window", window)
        call.option("run-up", run_up)
        call.option("without", ",".join(without) or None)
        call.option("seed", seed)
        for word in call.recordings(healthy):
            call.word(word)
        answer, _ = call.run(_results.Training, progress)
        text = Path(path).read_text(encoding="utf-8")
    answer.diagnoser = Diagnoser.parse(text, os.fspath(output or "diagnoser.toml"))
    return answer


def diagnose(
    diagnoser: PathName | Diagnoser,
    recording: AnyRecording,
    *,
    baseline: AnyRecording | None = None,
    method: str | None = None,
    beta: float | None = None,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Diagnosis:
    """Run a diagnoser over a recording: what failed, since when, and how large."""
    if not isinstance(recording, Recording):
        named = isinstance(recording, (str, os.PathLike))
        recording = Recording.read(recording) if named else Recording(recording)
    with _scratch() as scratch:
        call = _Call("diagnose", scratch)
        call.option("baseline", None if baseline is None else call.recording(baseline))
        call.option("method", method)
        call.option("beta", beta)
        call.option("seed", seed)
        call.word(call.text(diagnoser))
        call.word(call.recording(recording))
        answer, _ = call.run(_results.Diagnosis, progress)
    answer.recording = recording
    return answer


def export_fmu(
    drive: AnyDrive,
    output: PathName,
    *,
    fmi: Literal[2, 3] = 3,
    open_loop: bool = False,
    progress: Progress = None,
) -> _results.Export:
    """Write a drive as an FMU that any simulator of FMI 2.0 or 3.0 runs."""
    with _scratch() as scratch:
        call = _Call("export", scratch)
        call.option("output", output)
        call.option("fmi", fmi)
        call.option("open-loop", open_loop)
        call.word(call.text(drive))
        answer, _ = call.run(_results.Export, progress)
    return answer


def campaign(
    plan: PathName,
    output: PathName,
    *,
    shard: tuple[int, int] | None = None,
    resume: bool = False,
    seed: int | None = None,
    progress: Progress = None,
) -> _results.Campaign:
    """Run the many faulty scenarios of a plan file; `shard` is (I, N), from 1 on."""
    with _scratch() as scratch:
        call = _Call("campaign", scratch)
        call.option("output", output)
        call.option("shard", None if shard is None else "/".join(map(str, shard)))
        call.option("resume", resume)
        call.option("seed", seed)
        call.word(os.fspath(plan))
        answer, _ = call.run(_results.Campaign, progress)
    answer.folder = Path(output)
    return answer
