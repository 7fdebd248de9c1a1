"""Good recordings whose signals are spoiled: foreign, shifted, turned, in another unit, spiked,
frozen, cut off, coarse, with holes, at rest.

Every spoiling takes the columns of a good recording and gives spoiled ones; `EXPECTED` says what
is to be found in which channel.
"""

from dataclasses import dataclass

import numpy as np

INPUTS = ("u", "C_m", "torque", "force")
MOTION = ("omega", "v", "theta", "x", "position", "v_motor")
CURRENTS = ("i", "I_m", "Iq_measured")


@dataclass
class Table:
    """The columns of a file: `headers` as they are, `names` without units."""

    headers: list
    values: np.ndarray

    @property
    def names(self):
        return [header.split(" [")[0].strip() for header in self.headers]

    @property
    def period(self):
        return float(np.median(np.diff(self.values[:, 0])))

    def driver(self):
        """The column that drives."""
        for name in [*INPUTS, *CURRENTS]:
            if name in self.names:
                return name
        raise ValueError(f"nothing drives among {self.names}")

    def outputs(self):
        """What answers: motion, and the current beside a voltage."""
        shown = [name for name in self.names if name in MOTION]
        beside = self.driver() in ("u", "C_m") and "torque" not in self.names
        return shown + [name for name in self.names if beside and name in CURRENTS]

    def told(self):
        """What is compared with a model: a position beside a speed is not."""
        shown = [name for name in self.outputs() if name not in ("theta", "x", "position")]
        return shown if any(name in MOTION for name in shown) else self.outputs()

    def motion(self):
        return [name for name in self.names if name in MOTION]

    def changed(self, **columns):
        values = self.values.copy()
        for name, column in columns.items():
            values[:, self.names.index(name)] = column
        return Table(self.headers, values)

    def column(self, name):
        return self.values[:, self.names.index(name)]


def load(path):
    """A file with one header row, comments before it left out."""
    with open(path, encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")]
    return Table(lines[0].strip().split(","), np.genfromtxt(lines[1:], delimiter=","))


def save(path, table):
    """Holes are empty cells."""
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(table.headers) + "\n")
        for row in table.values:
            file.write(",".join("" if np.isnan(it) else f"{it:.12g}" for it in row) + "\n")


def _noise(table, names, rng):
    def random(name):
        column = table.column(name)
        return np.nanmean(column) + np.nanstd(column) * rng.standard_normal(len(column))

    return table.changed(**{name: random(name) for name in names})


def noise(table, _other, rng):
    """All outputs are noise."""
    return _noise(table, table.outputs(), rng)


def noise_current(table, _other, rng):
    """The current alone is noise."""
    names = [name for name in table.outputs() if name in CURRENTS]
    return _noise(table, names, rng) if names else None


def other_run(table, other, _rng):
    """The outputs of another run, where its input is another."""
    if other is None:
        return None
    rows = min(len(table.values), len(other.values))
    mine, its = table.column(table.driver())[:rows], other.column(table.driver())[:rows]
    if np.std(mine) == 0 or np.std(its) == 0 or abs(np.corrcoef(mine, its)[0, 1]) > 0.3:
        return None
    cut = Table(table.headers, table.values[:rows])
    return cut.changed(**{name: other.column(name)[:rows] for name in table.outputs()})


def shifted(seconds):
    """All outputs so many seconds late."""

    def spoil(table, _other, _rng):
        rows = round(seconds / table.period)
        if rows > 0.3 * len(table.values):
            return None
        cut = Table(table.headers, table.values[rows:].copy())
        columns = {name: table.column(name)[:-rows] for name in table.outputs()}
        return cut.changed(**columns)

    return spoil


def times(kind, factor):
    """The channels of a kind, `motion`, `current` or `driver`, so many times too large."""

    def spoil(table, _other, _rng):
        names = {
            "motion": table.motion(),
            "current": [name for name in table.outputs() if name in CURRENTS],
            "driver": [table.driver()],
        }[kind]
        columns = {name: factor * table.column(name) for name in names}
        return table.changed(**columns) if names else None

    return spoil


def spikes(table, _other, rng):
    """Three samples of one output far out, one of them 1e9."""
    name = str(rng.choice(table.outputs()))
    column = table.column(name).copy()
    rows = rng.choice(np.arange(20, len(column) - 20), 3, replace=False)
    reach = np.nanmax(column) - np.nanmin(column)
    column[rows] = [1e9, column[rows[1]] + 20 * reach, column[rows[2]] - 20 * reach]
    return table.changed(**{name: column})


def frozen(table, _other, rng):
    """One output keeps its value over a tenth of the recording, where it moves."""
    name = str(rng.choice(table.outputs()))
    column = table.column(name).copy()
    length = len(column) // 10
    starts = np.arange(length, len(column) - 2 * length, max(1, length // 7))
    # Where it goes furthest: at rest nobody could tell.
    moves = [np.ptp(column[start : start + length]) for start in starts]
    start = int(starts[int(np.argmax(moves))])
    column[start : start + length] = column[start]
    return table.changed(**{name: column})


def saturated(table, _other, rng):
    """A speed or a current cut off at the level that it exceeds in a fifth of the samples."""
    names = [it for it in table.outputs() if it in ("omega", "v", "v_motor", *CURRENTS)]
    if not names:
        return None
    name = str(rng.choice(names))
    column = table.column(name)
    limit = np.nanquantile(np.abs(column), 0.8)
    return table.changed(**{name: np.clip(column, -limit, limit)})


def coarse(table, _other, rng):
    """An output in ten levels."""
    name = str(rng.choice(table.told()))
    column = table.column(name)
    step = np.ptp(column[np.isfinite(column)]) / 9
    return table.changed(**{name: np.round(column / step) * step})


def holes(table, _other, rng):
    """A fifth of an output's samples missing, in stretches."""
    name = str(rng.choice(table.told()))
    column = table.column(name).copy()
    length = len(column) // 50
    for start in rng.choice(len(column) - length, 11, replace=False):
        column[start : start + length] = np.nan
    return table.changed(**{name: column})


def rest(table, _other, rng):
    """The shaft is blocked: all outputs are the sensors' noise."""
    if table.driver() not in ("u", "C_m", "torque", "force", *CURRENTS):
        return None
    columns = {}
    for name in table.motion():
        column = table.column(name)
        columns[name] = 1e-3 * np.nanstd(column) * rng.standard_normal(len(column))
    return table.changed(**columns)


RPM, DEGREE = 60.0 / (2.0 * np.pi), 180.0 / np.pi
# Noise alone is a shaft that does not move.
FOREIGN = {"no_answer", "shifted", "sign", "at_rest"}
UNIT = {"unit", "refused"}
SPOILINGS = {
    "noise": (noise, FOREIGN),
    "noise_current": (noise_current, FOREIGN),
    "other_run": (other_run, FOREIGN),
    "late_1.5_s": (shifted(1.5), FOREIGN),
    "late_3_s": (shifted(3.0), FOREIGN),
    "turned_motion": (times("motion", -1.0), FOREIGN),
    "turned_current": (times("current", -1.0), FOREIGN),
    "turned_driver": (times("driver", -1.0), FOREIGN),
    "motion_x_1000": (times("motion", 1000.0), UNIT),
    "motion_x_rpm": (times("motion", RPM), UNIT),
    "motion_/_rpm": (times("motion", 1.0 / RPM), UNIT),
    "motion_x_degrees": (times("motion", DEGREE), UNIT),
    "current_x_1000": (times("current", 1000.0), UNIT),
    "driver_x_1000": (times("driver", 1000.0), UNIT),
    "driver_/_1000": (times("driver", 1e-3), UNIT),
    "spikes": (spikes, {"spikes"}),
    "frozen": (frozen, {"frozen"}),
    "saturated": (saturated, {"saturated"}),
    "coarse": (coarse, {"coarse"}),
    "holes": (holes, {"missing"}),
    "rest": (rest, {"at_rest"}),
}
"""What is done to a recording, and which findings tell it."""
