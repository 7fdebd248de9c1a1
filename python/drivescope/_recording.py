"""Recordings: uniformly sampled signals with names and units, as numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _drivescope
from ._page import framed

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    from numpy.typing import NDArray

#: Columns by name, `{"omega": "Speed:rpm"}`, or as the command line has them.
Columns = Mapping[str, str] | str

TIME = "time [s]"


def _said(columns: Columns | None) -> str | None:
    if columns is None or isinstance(columns, str):
        return columns
    return ",".join(f"{signal}={column}" for signal, column in columns.items())


def _numbers(values: Any) -> NDArray[np.float64] | None:
    """Return values as doubles, one after the other, without a copy where they are so already."""
    if hasattr(values, "to_numpy"):
        try:
            kind = getattr(getattr(values, "dtype", None), "kind", "")
            if kind == "M":
                values = values.to_numpy(dtype="datetime64[ns]")
            elif kind != "m":
                # Missing values of nullable types are NaN.
                values = values.to_numpy(dtype="float64", na_value=np.nan)
        except TypeError:
            values = values.to_numpy()
        except ValueError:
            return None
    array = np.asarray(values)
    if array.dtype.kind in "mM":
        array = (array - array[0]) / np.timedelta64(1, "s") if len(array) else array.astype(float)
    if array.dtype.kind not in "fiub":
        return None
    return np.ascontiguousarray(array, dtype=np.float64)


def _headers(data: Any) -> Iterator[tuple[str, Any]]:
    """Yield the columns of a data frame, an Arrow table or a mapping, each with its header."""
    if hasattr(data, "column_names"):
        yield from ((str(name), data.column(name)) for name in data.column_names)
        return
    if hasattr(data, "index") and hasattr(data, "iloc"):
        index = data.index
        if index.name is not None:
            yield str(index.name), index
        elif index.dtype.kind in "mM":
            # Instants are seconds from the first.
            yield TIME, index
    names = data.columns if hasattr(data, "columns") else data
    yield from ((str(name), data[name]) for name in names)


class Recording:
    """Uniformly sampled signals that share one time axis, in one segment or several.

    `data` is a data frame (pandas, polars), an Arrow table or a mapping of arrays, with headers
    like `omega [rad/s]`: names and units are recognised, and converted, in the same way, and
    `remarks` tells what was assumed. One column is the time, or a named or a time index is, unless
    `rows_every` says how far rows lie apart, in s. Columns that are not numbers are left out.
    """

    def __init__(
        self,
        data: Any,
        *,
        name: str = "recording",
        columns: Columns | None = None,
        resample: float | None = None,
        rows_every: float | None = None,
    ) -> None:
        found = [(header, _numbers(values)) for header, values in _headers(data)]
        self._left_out = [
            f"column `{header}` holds no numbers" for header, it in found if it is None
        ]
        signals = [(header, it) for header, it in found if it is not None]
        self._held = _drivescope.Recording.of_columns(
            name, signals, _said(columns), resample, rows_every
        )

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        columns: Columns | None = None,
        resample: float | None = None,
        rows_every: float | None = None,
    ) -> Recording:
        """Read a file of any format that the program knows."""
        return cls._of(_drivescope.Recording.read(path, _said(columns), resample, rows_every))

    @classmethod
    def _of(cls, held: _drivescope.Recording) -> Recording:
        made = cls.__new__(cls)
        made._left_out = []
        made._held = held
        return made

    @property
    def name(self) -> str:
        """What it came from."""
        return self._held.name

    @property
    def start(self) -> float:
        """Time of the first sample, s."""
        return self._held.start

    @property
    def period(self) -> float:
        """Sampling time, s."""
        return self._held.period

    @property
    def units(self) -> dict[str, str]:
        """Units of the signals by their names."""
        return dict(self._held.units)

    @property
    def remarks(self) -> list[str]:
        """What was assumed in reading, and what deserves attention."""
        return self._left_out + self._held.remarks

    @property
    def time(self) -> NDArray[np.float64]:
        """When the samples were taken, s."""
        return self._held.times()

    @property
    def segments(self) -> list[slice]:
        """The samples of each segment."""
        return [slice(first, end) for first, end in self._held.segments()]

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self._held)

    def __getitem__(self, signal: str) -> NDArray[np.float64]:
        """Return the values of a signal: its own, so that they cannot be written to."""
        names = [name for name, _ in self._held.units]
        try:
            values = self._held.values(names.index(signal))
        except ValueError:
            raise KeyError(f"{signal}: there are {', '.join(names)}") from None
        assert values is not None
        return values

    def __contains__(self, signal: object) -> bool:
        return signal in self.units

    def __iter__(self) -> Iterator[str]:
        return iter(self.units)

    def _columns(self) -> dict[str, NDArray[np.float64]]:
        columns = {TIME: self.time}
        columns |= {f"{name} [{unit or '1'}]": self[name] for name, unit in self._held.units}
        if len(self.segments) > 1:
            lengths = [it.stop - it.start for it in self.segments]
            columns["segment [1]"] = np.repeat(np.arange(1.0, len(lengths) + 1.0), lengths)
        return columns

    def to_pandas(self) -> pd.DataFrame:
        """Return a data frame with the headers of a file; `Recording` takes it back."""
        import pandas

        return pandas.DataFrame(self._columns(), copy=False)

    def to_arrow(self) -> pa.Table:
        """Return an Arrow table with the headers of a file, over the same memory."""
        import pyarrow

        return pyarrow.table(self._columns())

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file (`.csv`, `.parquet`), whole or not at all."""
        self._held.write(path)

    def page(self, spans: Sequence[tuple[float, float, str]] = ()) -> str:
        """Return a page that shows the signals, with spans: from, to, s, and what they say."""
        return self._held.page(list(spans))

    def _repr_html_(self) -> str:
        return framed(self.page())

    def __repr__(self) -> str:
        names = ", ".join(self.units)
        return f"Recording({self.name!r}, {len(self)} samples every {self.period:g} s: {names})"
