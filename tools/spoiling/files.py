"""Spoiled files on disk: the file, `NAME.truth.json` and `NAME.truth.npz` beside it."""

import dataclasses
import json
from pathlib import Path

import numpy as np

from . import clean, layout
from .naming import WORDS, Column

UNKNOWN = [("vibration", "g"), ("aux3", ""), ("bus_voltage", "V"), ("status_code", "")]
WORDS_IN_CELLS = ["ok", "start", "läuft", "stop"]
MISSING_CELLS = 12
SINCE_FIRST = {"epoch_stamps", "iso_stamps", "clock_over_midnight"}
"""Clocks that are read as seconds since the first row."""


def write(folder, name, draft):
    """The file and its truth; returns the file's path."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    log = draft.log
    values = {signal.name: _sampled(draft, signal) for signal in draft.clean.signals}
    printed = {it.name: draft.naming.signal(it, values[it.name]) for it in draft.clean.signals}
    _tell_apart(draft, values, printed)
    for signal, column in printed.items():
        values[signal], column.cells = _with_holes(draft, values[signal], column.cells)
    columns = list(printed.values())
    clock, tick = _clock(draft)
    columns = _in_order(draft, clock, columns + _extra(draft))
    for column in columns:
        column.cells = [column.cells[row] for row in log.order]
    path = folder / f"{name}.csv"
    path.write_bytes(draft.layout.bytes(columns, draft.naming, draft.clean.period))
    np.savez(folder / f"{name}.truth.npz", t=log.t, stamp=log.stamp, run=log.run, **values)
    signals = [
        dataclasses.asdict(signal) | {"quantum": draft.naming.quanta[signal.name]}
        for signal in draft.clean.signals
    ]
    truth = {
        "file": path.name,
        "kind": draft.clean.kind,
        "spoilings": draft.spoilings,
        "done": draft.done,
        "period_s": draft.clean.period,
        "tick_s": max(tick, log.coarse),
        "from_first_row": draft.clock in SINCE_FIRST,
        "instants": log.instants,
        "signals": signals,
        "columns": {signal: column.name for signal, column in printed.items()},
    }
    (folder / f"{name}.truth.json").write_text(json.dumps(truth, indent=1) + "\n", "utf-8")
    return path


def load(path):
    """Truth of a file, arrays included."""
    path = Path(path)
    truth = json.loads(path.with_suffix(".truth.json").read_text("utf-8"))
    with np.load(path.with_suffix(".truth.npz")) as arrays:
        truth |= {"t": arrays["t"], "stamp": arrays["stamp"], "run": arrays["run"]}
        truth["values"] = {it["name"]: arrays[it["name"]] for it in truth["signals"]}
    for signal in truth["signals"]:
        signal["of"] = clean.Signal(**{k: v for k, v in signal.items() if k != "quantum"})
    return truth


def _sampled(draft, signal):
    log = draft.log
    if signal.held:
        return draft.clean.levels[signal.name][log.sample]
    return signal.at(log.t) + signal.noise * draft.rng.standard_normal(len(log.t))


def _tell_apart(draft, values, printed):
    """Rows of one stamp that are alike by chance would be taken for one sent twice."""
    stamp = draft.log.stamp
    if draft.log.coarse > 0.0:
        return
    smooth = next(signal for signal in draft.clean.signals if not signal.held)
    column, quantum = printed[smooth.name], draft.naming.quanta[smooth.name]
    for row in range(1, len(stamp)):
        if stamp[row] == stamp[row - 1] and column.cells[row] == column.cells[row - 1]:
            decimals = len(column.cells[row].partition(".")[2])
            values[smooth.name][row] += quantum
            column.cells[row] = f"{float(column.cells[row]) + 10.0**-decimals:.{decimals}f}"


def _with_holes(draft, values, cells):
    """Some values are missing."""
    if draft.layout.missing is None:
        return values, cells
    values = values.copy()
    for row in draft.rng.integers(0, len(values), int(draft.rng.integers(0, MISSING_CELLS))):
        values[row] = np.nan
        cells[row] = draft.layout.missing
    return values, cells


def _clock(draft):
    rng, stamps = draft.rng, draft.log.stamp
    name = draft.naming.name("time")
    decimals = 6
    match draft.clock:
        case "epoch_stamps":
            unit, factor, fine = [("s", 1, 6), ("ms", 1000, 3), ("us", 1_000_000, 0)][
                int(rng.integers(3))
            ]
            told = unit if rng.random() < 0.5 or draft.layout.unit_row else ""
            return layout.number_clock(stamps, name, told, factor, fine, layout.EPOCH)
        case "iso_stamps":
            mark = "T" if draft.has("blanks") else str(rng.choice(["T", " "]))
            zone = str(rng.choice(["", "Z", "+02:00"]))
            return layout.iso_clock(stamps, name, _clock_decimals(draft), mark, zone)
        case "clock_over_midnight":
            return layout.day_clock(stamps, name, _clock_decimals(draft))
        case "time_units":
            unit, factor, decimals = [("ms", 1e3, 3), ("us", 1e6, 0)][int(rng.integers(2))]
            return layout.number_clock(stamps, name, unit, factor, decimals)
    return layout.number_clock(stamps, name, "s", 1.0, decimals)


def _clock_decimals(draft):
    """Milliseconds where they do for the sampling."""
    return 3 if draft.clean.period > 4e-3 and draft.rng.random() < 0.5 else 6


def _extra(draft):
    rng, log, columns = draft.rng, draft.log, []
    rows = len(log.t)
    for kind in draft.extra:
        match kind:
            case "note":
                columns.append(Column("Prüfgröße", "", ["µ"] * rows, number=False))
            case "text":
                words = rng.choice(WORDS_IN_CELLS, rows).tolist()
                columns.append(Column("Bemerkung", "", words, number=False))
            case "constant":
                columns.append(Column("gain", "", ["2.5"] * rows))
            case "empty":
                columns.append(Column("reserved", "", [""] * rows))
            case "unknown":
                for at in rng.choice(len(UNKNOWN), 2, replace=False):
                    name, unit = UNKNOWN[at]
                    cells = np.char.mod("%.4f", rng.normal(0.0, 3.0, rows)).tolist()
                    columns.append(Column(name, unit, cells))
    if log.numbered:
        words = WORDS.get(draft.naming.language, WORDS["english"])["run"]
        cells = np.char.mod("%d", log.run + 1).tolist()
        columns.append(Column(str(rng.choice(words)), "", cells))
    return columns


def _in_order(draft, clock, columns):
    """Time first unless the columns are shuffled; what is no signal stands anywhere."""
    columns = [columns[k] for k in draft.rng.permutation(len(columns))]
    at = int(draft.rng.integers(0, len(columns) + 1)) if draft.shuffled else 0
    columns.insert(at, clock)
    return columns
