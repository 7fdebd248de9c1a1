"""Answers of the commands: mappings of what `--json` writes, that show themselves in notebooks."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _page
from ._drive import Diagnoser, Drive
from ._recording import Recording

if TYPE_CHECKING:
    import pandas as pd


class Answer(Mapping[str, Any]):
    """What a command answers: a mapping of what `--json` writes."""

    #: The answer as `--json` writes it, byte for byte.
    json: str
    #: The answer for a person, as the command prints it.
    text: str
    #: What was said beside it: what was assumed and what is doubtful, a line each.
    remarks: list[str]

    def __init__(self, text: str, json: str, remarks: list[str]) -> None:
        self.text = text
        self.json = json
        self.remarks = remarks

    @cached_property
    def data(self) -> dict[str, Any]:
        """What the JSON holds."""
        return json.loads(self.json)

    def __getitem__(self, key: str) -> Any:
        return self.data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def __len__(self) -> int:
        return len(self.data)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.text.strip().splitlines()[0] if self.text else ''}>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.text)}</pre>"


class _Reported(Answer):
    """An answer with a report."""

    #: The report: one self-contained page, as the command writes it.
    report: str

    def write_report(self, path: str | os.PathLike[str]) -> None:
        """Write the report, whole or not at all."""
        from ._drive import write_whole

        write_whole(path, self.report)

    def _repr_html_(self) -> str:
        return _page.framed(self.report)


class Simulation(Answer):
    """What `simulate` answers."""

    #: What the sensors showed.
    recording: Recording

    def _repr_html_(self) -> str:
        return self.recording._repr_html_()


class Comparison(_Reported):
    """What `compare` answers."""


class Fit(Answer):
    """What `fit` answers."""

    #: The drive with the estimated values.
    drive: Drive

    def to_pandas(self) -> pd.DataFrame:
        """Return the parameters with their standard errors."""
        import pandas

        return pandas.DataFrame.from_dict(self["parameters"], orient="index")

    def _repr_html_(self) -> str:
        def number(value: float | None) -> str:
            return "" if value is None else f"{value:.4g}"

        rows = [
            (name, number(it["value"]), number(it["std_error"]), it.get("unit", ""))
            for name, it in self["parameters"].items()
        ]
        head = ("parameter", "value", "standard error", "unit")
        return _page.table(head, rows) + super()._repr_html_()


class Discovery(_Reported):
    """What `discover` and `add` answer."""

    #: The drive with what was found; none where nothing could be judged.
    drive: Drive | None


class Study(_Reported):
    """What `study` answers."""


class Training(Answer):
    """What `train` answers."""

    #: The diagnoser.
    diagnoser: Diagnoser


class Diagnosis(Answer):
    """What `diagnose` answers."""

    #: What was diagnosed.
    recording: Recording

    def _repr_html_(self) -> str:
        end = float(self.recording.time[-1])
        spans = [
            (
                float(it["from"]),
                end if it.get("to") is None else float(it["to"]),
                str(it.get("mechanism") or it.get("fault") or "fault"),
            )
            for it in self["declarations"]
        ]
        return _page.framed(self.recording.page(spans)) + super()._repr_html_()


class Export(Answer):
    """What `export` answers."""


class Campaign(Answer):
    """What `campaign` answers."""

    #: Where the results are.
    folder: Path

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a scenario, of all shares that are there."""
        import pandas

        parts = sorted(self.folder.glob("*.parquet"))
        return pandas.concat([pandas.read_parquet(it) for it in parts], ignore_index=True)
