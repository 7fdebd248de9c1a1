"""A scheduler and three workers on this machine, as processes that can be killed."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from drivescope import dask

#: No wait is longer, s.
PATIENCE = 120.0
WORKERS = 3
#: The scenario that ends the process which runs it.
POISON = 333

PLAN = """\
schema = 1
name = "spread"
drive = "bench.toml"
seed = 5
draws = 120
duration = 15.0

[[fault]]
kind = { grid = ["tacho", "flux", "actuator", "load"] }
size = { uniform = [0.01, 0.2] }
onset = { uniform = [12.0, 13.0] }
duration = 2.0

[detector]
methods = ["constant", "cusum"]
"""


def slowly(work: dask.Work, first: int, end: int) -> dask.Made:
    """Run scenarios so that there is time to kill, and end the process at one of them."""
    import os
    import time

    time.sleep(0.2)
    if first <= POISON < end:
        os.abort()
    return dask.run(work, first, end)


def until(happened: Callable[[], bool], what: str) -> None:
    """Wait for something, and fail where it does not happen."""
    limit = time.monotonic() + PATIENCE
    while not happened():
        if time.monotonic() > limit:
            raise TimeoutError(what)
        time.sleep(0.05)


class Cluster:
    """Scheduler and workers."""

    def __init__(self) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{port}"
        self._log = Path("cluster.log").open("a")
        options = ["--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
        self.scheduler = self._start("dask_scheduler", *options)
        worker = [self.address, "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"]
        worker += ["--death-timeout", "60", "--memory-limit", "0"]
        self.nannies = [self._start("dask_worker", *worker) for _ in range(WORKERS)]

    def _start(self, command: str, *arguments: str) -> subprocess.Popen[bytes]:
        words = [sys.executable, "-m", f"distributed.cli.{command}", *arguments]
        environment = {
            **os.environ,
            # What the workers run stands in this file.
            "PYTHONPATH": str(Path(__file__).parent),
            "RAYON_NUM_THREADS": "1",
            # A batch is suspected after it has ended two workers, not four.
            "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
        }
        return subprocess.Popen(words, stdout=self._log, stderr=self._log, env=environment)

    def end(self) -> None:
        """End all of it at once."""
        for process in (self.scheduler, *self.nannies):
            process.kill()
            process.wait(PATIENCE)
        self._log.close()
