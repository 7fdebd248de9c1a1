"""The compiled module; the package wraps it."""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__version__: str

class Error(ValueError):
    """Input that cannot be used: what is wrong, where, and the next step."""

class Recording:
    name: str
    start: float
    period: float
    units: list[tuple[str, str]]
    remarks: list[str]
    @staticmethod
    def read(
        path: str | PathLike[str],
        columns: str | None,
        resample: float | None,
        rows_every: float | None,
    ) -> Recording: ...
    @staticmethod
    def of_columns(
        name: str,
        signals: Sequence[tuple[str, NDArray[np.float64]]],
        columns: str | None,
        resample: float | None,
        rows_every: float | None,
    ) -> Recording: ...
    def __len__(self) -> int: ...
    def values(self, at: int) -> NDArray[np.float64] | None: ...
    def times(self) -> NDArray[np.float64]: ...
    def segments(self) -> list[tuple[int, int]]: ...
    def write(self, path: str | PathLike[str]) -> None: ...
    def page(self, spans: Sequence[tuple[float, float, str]]) -> str: ...

class Answer:
    text: str
    json: str
    remarks: list[str]
    forbidden: bool
    recordings: dict[str, Recording]

def call(
    arguments: Sequence[str],
    recordings: Sequence[tuple[str, Recording]],
    scratch: str,
    progress: Callable[[str, int, int | None], object] | None,
) -> Answer: ...
def drive(given: str) -> tuple[str, str]: ...
def drive_name(text: str, name: str) -> str: ...
def leave_nothing() -> None: ...
def main(arguments: Sequence[str]) -> int: ...

class Scenarios:
    count: int
    plan: str
    drive_name: str
    fmu_name: str | None
    design: str
    digest: str
    @staticmethod
    def in_folder(
        plan: str | PathLike[str], folder: str | PathLike[str], design: str | None = None
    ) -> Scenarios: ...
    def release(self) -> None: ...
    def run(self, first: int, end: int, file: str | PathLike[str]) -> list[Path]: ...
    def aborted(self, scenario: int, file: str | PathLike[str]) -> None: ...
    def missing(
        self, folder: str | PathLike[str]
    ) -> tuple[list[tuple[int, int]], list[tuple[str, str]]]: ...
    def write_traces(
        self, folder: str | PathLike[str], first: int, end: int, aborted: Sequence[int]
    ) -> None: ...

def part(first: int, end: int) -> str: ...
def merged(folder: str | PathLike[str]) -> str: ...
