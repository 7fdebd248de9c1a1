#!/usr/bin/env python3
"""Converts a recording that drivescope does not read itself into CSV or Parquet.

    python tools/convert_recording.py IN OUT.csv [--group NAME]

The input may be Excel (.xlsx, .xls, .ods), MAT (any version), HDF5, TDMS (raw DAQmx data too),
MDF 3 and 4, Parquet (any packer) or CSV. The output has the columns `time [s],name [unit],...`.
Series of another length than the time, texts and nested things are left out and named. Each kind
needs its own package, which an error names: pip install pandas pyarrow scipy h5py nptdms asammdf
openpyxl xlrd odfpy.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

#: A matrix with more columns is a picture, not signals.
MOST_COLUMNS = 100


class NotConverted(Exception):
    """A recording that holds no table; the text says why, and what to do."""


def excel(path, group):
    import pandas as pd

    for name, sheet in pd.read_excel(path, sheet_name=None).items():
        numbers = sheet.select_dtypes(["number", "datetime"])
        if (group is None or name == group) and numbers.shape[1] > 1:
            return frame(numbers)
    raise NotConverted("no sheet has a row of names above rows of numbers")


def parquet(path, _group):
    import pandas as pd

    return frame(pd.read_parquet(path))


def frame(table):
    """Columns of a data frame; dates as seconds since the first."""
    columns = {}
    for name in table.columns:
        values = table[name]
        if values.dtype.kind == "M":
            since = (values - values.iloc[0]).dt.total_seconds()
            columns[with_unit(str(name), "s")] = since.to_numpy()
        elif values.dtype.kind in "biuf":
            columns[str(name)] = values.to_numpy()
    return columns


def mat(path, group):
    import scipy.io

    try:
        found = scipy.io.loadmat(path, simplify_cells=True)
    except NotImplementedError:
        return hdf5(path, group)
    except ValueError as error:
        raise NotConverted(f"no MAT file: {error}") from error
    return flat({k: v for k, v in found.items() if not k.startswith("__")})


def hdf5(path, group):
    import h5py

    columns = {}

    def visit(name, item):
        if (
            isinstance(item, h5py.Dataset)
            and not name.startswith("#")
            and item.dtype.kind in "biuf"
        ):
            unit = next((item.attrs[k] for k in ("unit", "units", "Unit") if k in item.attrs), "")
            unit = unit.decode() if isinstance(unit, bytes) else str(unit)
            # MATLAB stores matrices transposed.
            columns[with_unit(name.replace("/", "."), unit)] = np.squeeze(item[()]).T
        elif isinstance(item, h5py.Dataset) and item.dtype.names:
            columns.update({f"{name}.{k}".replace("/", "."): item[k] for k in item.dtype.names})

    with h5py.File(path) as file:
        (file[group] if group else file).visititems(visit)
    return flat(columns)


def flat(tree, prefix=""):
    """Series of a tree of dictionaries and lists, under dotted names."""
    columns = {}
    for key, value in tree.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            columns.update(flat(value, f"{name}."))
        elif isinstance(value, list) or getattr(value, "dtype", np.dtype(float)).kind == "O":
            items = {f"{name}({k + 1})": v for k, v in enumerate(np.asarray(value, object).flat)}
            columns.update(flat(items))
        elif np.ndim(value) == 1:
            columns[name] = np.asarray(value)
        elif np.ndim(value) == 2 and min(value.shape) <= MOST_COLUMNS:
            rows = value if value.shape[0] >= value.shape[1] else value.T
            columns.update({f"{name}_{k + 1}": rows[:, k] for k in range(rows.shape[1])})
    return columns


def tdms(path, group):
    import nptdms

    with nptdms.TdmsFile.open(path) as file:
        groups = [it for it in file.groups() if group is None or it.name == group]
        best = max(groups, key=lambda it: max((len(c) for c in it.channels()), default=0))
        columns = {}
        for channel in best.channels():
            about = channel.properties
            if "wf_increment" in about and not any("time" in k.lower() for k in columns):
                columns["time [s]"] = channel.time_track()
            values = channel[:]
            if values.dtype.kind == "M":
                values = (values - values[0]) / np.timedelta64(1, "s")
            unit = str(about.get("unit_string", ""))
            columns[with_unit(channel.name, unit)] = values
    return columns


def mdf(path, group):
    import asammdf

    with asammdf.MDF(path) as file:
        sizes = [it.channel_group.cycles_nr for it in file.groups]
        names = [str(it.channel_group.comment or it.channel_group.acq_name) for it in file.groups]
        chosen = names.index(group) if group else int(np.argmax(sizes))
        columns = {}
        for signal in file.select(
            [(None, chosen, k) for k in range(len(file.groups[chosen].channels))]
        ):
            if "time [s]" not in columns:
                columns["time [s]"] = signal.timestamps
            if signal.samples.dtype.kind in "biuf" and signal.name not in ("time", "t"):
                columns[with_unit(signal.name, signal.unit)] = signal.samples
    return columns


def csv(path, _group):
    import pandas as pd

    return frame(pd.read_csv(path, sep=None, engine="python"))


READERS = {
    "csv": csv,
    "txt": csv,
    "h5": hdf5,
    "hdf": hdf5,
    "hdf5": hdf5,
    "mat": mat,
    "mdf": mdf,
    "mf4": mdf,
    "dat": mdf,
    "ods": excel,
    "parquet": parquet,
    "pq": parquet,
    "tdms": tdms,
    "xls": excel,
    "xlsm": excel,
    "xlsx": excel,
}


def with_unit(name, unit):
    return f"{name} [{unit}]" if unit and unit != "None" else name


def short(names):
    """Last parts of dotted names where they are nobody else's."""
    last = [name.split(" [")[0].split(".")[-1] + name[len(name.split(" [")[0]) :] for name in names]
    return [a if last.count(a) == 1 else b for a, b in zip(last, names, strict=True)]


def is_time(name):
    return name.split(" [")[0].lower() in {"t", "time", "timestamp", "tout", "zeit", "timestamps"}


def table(columns):
    """The columns of the time's length, time first; the names of the others."""
    columns = {k: np.asarray(v) for k, v in columns.items()}
    numbers = {
        k: v for k, v in columns.items() if v.ndim == 1 and v.dtype.kind in "biuf" and len(v) > 1
    }
    if not numbers:
        raise NotConverted("it holds no series of numbers")
    numbers = dict(zip(short(list(numbers)), numbers.values(), strict=True))
    time = next((k for k in numbers if is_time(k)), None)
    length = len(numbers[time]) if time else max(map(len, numbers.values()))
    kept = {k: v.astype(float) for k, v in numbers.items() if len(v) == length}
    if time:
        kept = {time: kept[time], **kept}
    return kept, [k for k in numbers if k not in kept]


def convert(path, out, group=None):
    """Writes the table of `path` to `out`; returns the names of what was left out."""
    reader = READERS.get(path.suffix.lower().lstrip("."))
    if reader is None:
        raise NotConverted(f"`{path.suffix}` is none of {', '.join(sorted(READERS))}")
    kept, left_out = table(reader(path, group))
    if out.suffix.lower() in (".parquet", ".pq"):
        import pyarrow as pa
        import pyarrow.parquet as pq

        pq.write_table(pa.table(kept), out)
    elif out.suffix.lower() == ".csv":
        rows = zip(*(it.tolist() for it in kept.values()), strict=True)
        with out.open("w", encoding="utf-8") as file:
            quoted = ['"' + k.replace('"', "'") + '"' if "," in k else k for k in kept]
            file.write(",".join(quoted) + "\n")
            file.writelines(",".join(repr(x) for x in row) + "\n" for row in rows)
    else:
        raise NotConverted(f"{out.name}: write .csv or .parquet")
    return left_out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("input", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--group", help="sheet, TDMS or HDF5 group, or MDF channel group to take")
    given = parser.parse_args()
    try:
        left_out = convert(given.input, given.output, given.group)
    except ImportError as error:
        sys.exit(f"{given.input}: needs the package {error.name}: pip install {error.name}")
    except (NotConverted, OSError, KeyError, ValueError) as error:
        sys.exit(f"{given.input}: cannot be converted: {error}")
    for name in left_out:
        print(f"left out: {name}: it has another length than the others")


if __name__ == "__main__":
    main()
