"""What was read, compared with the truth.

Stated errors of a sample: half a step of the printed digits where rows are samples; between rows
also the straight line's error, curvature * gap^2 / 8, the stamps' tick * slope, and the noise of
the sensors. Where sampling was even, samples are the rows themselves, whatever their stamps were;
they may be interpolated at their stamps only where stamps jitter and jitter * slope is below noise
and digits, and then that is their error. Time is that of a uniform grid whose last sample is no
more than a quarter of a step and what the stamps leave open off.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

SIGNALS = {
    *("u", "i", "omega", "v", "theta", "x", "reference", "T_l", "C_m", "T", "I_m", "temperature"),
    *("torque", "omega_load", "v_load", "theta_load", "x_load"),
}
DRIFT = 0.25
"""Steps that the grid may be off at the end of the longest run."""
SAME_RATE = 1e-3
"""Share by which sampling times of one rate may differ."""
EXACT = 0.01
"""Jitter below which stamps are those of samples, in steps."""
GRID = 1e-6
"""Steps that a printed time may be off its grid."""
SIGMAS = 6.0
"""Standard deviations of noise that a sample may be off: once in 10^9."""
ROUNDING = 1e-9
"""Share of the largest value that arithmetic may take."""
LONG_ENOUGH = 500
"""Samples that tell a noise gain within 0.1 by 4 standard errors."""
GAIN_OFF = 0.1


@dataclass
class Verdict:
    """What became of a file."""

    kind: str
    reasons: list = field(default_factory=list)
    read_s: float = 0.0


@dataclass
class Read:
    """What the program wrote of a file."""

    account: dict
    columns: dict = field(default_factory=dict)
    units: dict = field(default_factory=dict)

    def segments(self):
        """Ranges of samples."""
        rows = len(self.columns["time"])
        numbers = self.columns.get("segment", np.ones(rows))
        cuts = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), rows]
        return [slice(a, b) for a, b in zip(cuts[:-1], cuts[1:], strict=True)]


def load(folder, name):
    """What the program wrote of a file of that name."""
    account = json.loads((Path(folder) / f"{name}.json").read_text("utf-8"))
    read = Read(account)
    if "report" in account:
        with (Path(folder) / f"{name}.csv").open(encoding="utf-8") as file:
            # Names have no quotes and no commas here.
            for header in file.readline().strip().split(","):
                column, _, unit = header.strip('"').rpartition(" [")
                read.units[column] = unit.rstrip("]")
            values = np.loadtxt(file, delimiter=",", ndmin=2, unpack=True)
        read.columns = dict(zip(read.units, values, strict=True))
    return read


def judge(truth, read):
    """Whether a file was read as it was meant."""
    seconds = read.account["read_s"]
    for kind, word in (("panic", "panic"), ("error", "refused")):
        if kind in read.account:
            return Verdict(word, [read.account[kind]], seconds)
    reasons = _names(truth, read)
    if not reasons:
        reasons = _period(truth, read) + _values(truth, read)
    return Verdict("wrong" if reasons else "right", reasons, seconds)


def _names(truth, read):
    expected = {signal["name"]: signal["unit"] for signal in truth["signals"]}
    found = SIGNALS & set(read.columns)
    reasons = [
        f"column `{truth['columns'][name]}` is not read as {name}, but there is"
        f" {', '.join(set(read.columns) - {'time'})}"
        for name in expected.keys() - found
    ]
    reasons += [f"there is a {name} that nobody measured" for name in found - expected.keys()]
    wrong = [name for name in found & expected.keys() if read.units[name] != expected[name]]
    return reasons + [f"{name} is in {read.units[name]}" for name in wrong if name != "T"]


def _period(truth, read):
    found = read.account["report"]["sampling"]["period_s"]
    slower = (truth["done"].get("joined_rates") or {}).get("slower", 1)
    longest = max(_runs(truth), key=len)
    lasts = truth["t"][longest[-1]] - truth["t"][longest[0]]
    allowed = (DRIFT * truth["period_s"] * slower + truth["tick_s"]) / lasts
    off = min(abs(found / (truth["period_s"] * rate) - 1.0) for rate in (1, slower))
    if off <= allowed:
        return []
    return [f"sampling time {found} s, which is off by {100 * off:.2g} % of {truth['period_s']} s"]


def _runs(truth):
    """Rows of every run."""
    return [np.flatnonzero(truth["run"] == run) for run in np.unique(truth["run"])]


def _values(truth, read):
    runs = _runs(truth)
    segments = read.segments()
    if len(segments) != len(runs):
        return [f"{len(segments)} segments instead of {len(runs)}"]
    reasons, errors = [], {}
    for number, (rows, samples) in enumerate(zip(runs, segments, strict=True), 1):
        part = _Part(truth, read, rows, samples, number, runs)
        reasons += [f"segment {number}: {reason}" for reason in part.judged(errors)]
    return reasons or _noise(truth, read, errors)


def _noise(truth, read, errors):
    """Whether interpolation did to white noise what the program says."""
    gain = read.account["noise_gain"]["by_order"][0]
    reasons = []
    for signal in truth["signals"]:
        error = np.concatenate(errors.get(signal["name"], [np.zeros(0)]))
        error = error[np.isfinite(error)]
        if signal["noise"] == 0.0 or len(error) < LONG_ENOUGH:
            continue
        ratio = np.sqrt(np.mean(error**2)) / signal["noise"]
        if abs(ratio / gain - 1.0) > GAIN_OFF:
            reasons.append(
                f"noise of {signal['name']} is {ratio:.3f} of what it was, not {gain:.3f}"
            )
    return reasons


class _Part:
    """A segment beside the run that it should be."""

    def __init__(self, truth, read, rows, samples, number, runs):
        self.truth, self.number = truth, number
        self.time = read.columns["time"][samples]
        self.read = {name: values[samples] for name, values in read.columns.items()}
        self.period = read.account["report"]["sampling"]["period_s"]
        # Where two rates meet, the row between belongs to either.
        self.loose = int("joined_rates" in truth["done"])
        self.reasons = []
        self.late = self._lateness(rows)
        rows = rows[self._first(read, rows, samples, runs) :]
        self.t, self.stamp = truth["t"][rows], truth["stamp"][rows]
        self.values = {name: values[rows] for name, values in truth["values"].items()}
        steps = np.median(np.diff(self.t)) / truth["period_s"]
        self.step = max(1, round(steps)) * truth["period_s"]

    def _lateness(self, rows):
        """How far stamps are from the clock of their run, s."""
        behind = self.truth["stamp"][rows] - self.truth["t"][rows]
        return 0.0 if self.truth["instants"] else float(np.abs(behind - np.median(behind)).max())

    def _first(self, read, rows, samples, runs):
        """Which row of the run the segment begins with."""
        stamp, tick = self.truth["stamp"], self.truth["tick_s"]
        base = 0.0 if self.truth["from_first_row"] else stamp[runs[0][0]]
        expected = stamp[rows[: 1 + self.loose]] - stamp[runs[0][0]] + base
        off = np.abs(expected - self.time[0])
        # A clock may be that of all rows and not of the first alone.
        if off.min() <= tick + self.late + self._lateness(runs[0]) + ROUNDING:
            return int(np.argmin(off))
        # A clock that runs back, or one behind it, is set behind what was read before.
        earlier = read.columns["time"][: samples.start]
        if not len(earlier) or expected[0] > earlier[-1] + 0.5 * self.period + tick:
            self.reasons.append(f"begins at {self.time[0]} s instead of {expected[0]} s")
        return 0

    def judged(self, errors):
        """What is wrong with it; errors of smooth signals are added to `errors`."""
        if self.reasons:
            return self.reasons
        grid = self.time[0] + self.period * np.arange(len(self.time))
        if np.abs(self.time - grid).max() > GRID * self.period:
            return ["time is not uniform"]
        even = self._at_rows()
        if not even and (not self.truth["instants"] or not self._jitter_shows()):
            self._keep(errors, self.t[0] + self.step * np.arange(len(self.time)))
            return []
        same_rate = abs(self.period / self.step - 1.0) < SAME_RATE
        told = self._jitter_shows() or self._is_exact()
        if not self.truth["instants"] and same_rate and told:
            return even
        between = self._between()
        self._keep(errors, self.t[0] + self.time - self.time[0])
        return between

    def _keep(self, errors, t):
        """What is left beside a straight line between rows without noise, whatever the clocks
        differ by."""
        for signal in self.truth["signals"]:
            if not signal["held"]:
                line = np.interp(t, self.t, signal["of"].at(self.t))
                error = self.read[signal["name"]] - line
                # A grid that is late, or a little too long.
                slope = np.gradient(line)
                late = np.column_stack([slope, slope * (t - t[0])])
                known = np.isfinite(error)
                share = np.linalg.lstsq(late[known], error[known], rcond=None)[0]
                errors.setdefault(signal["name"], []).append(error - late @ share)

    def _jitter_shows(self):
        """Whether a person could tell instants from stamps by the signals."""
        grid = self.step * np.round((self.t - self.t[0]) / self.step)
        departure = self.t - self.t[0] - grid if self.truth["instants"] else self.stamp - self.t
        jitter = np.std(departure)
        shown = [
            jitter * signal["of"].slope_rms() > np.hypot(signal["noise"], signal["quantum"])
            for signal in self.truth["signals"]
            if not signal["held"]
        ]
        return any(shown)

    def _is_exact(self):
        """Whether stamps are even enough to be samples as they stand."""
        return max(self.late, self.truth["tick_s"]) <= EXACT * self.step

    def _at_rows(self):
        """Sample j is row j, empty places on a straight line; what contradicts that."""
        place = np.round((self.t - self.t[0]) / self.step).astype(int)
        reasons = []
        if len(self.time) != place[-1] + 1:
            return [f"{len(self.time)} samples instead of {place[-1] + 1}"]
        lost = np.setdiff1d(np.arange(place[-1] + 1), place)
        for signal in self.truth["signals"]:
            name, y = signal["name"], self.values[signal["name"]]
            found = self.read[name]
            allowed = 0.5 * signal["quantum"] + ROUNDING * signal["of"].largest()
            reasons += self._compared(name, found[place], y, allowed, place)
            after = np.searchsorted(place, lost)
            share = (lost - place[after - 1]) / (place[after] - place[after - 1])
            expected = y[after - 1] + share * (y[after] - y[after - 1])
            reasons += self._compared(name, found[lost], expected, allowed, lost)
        return reasons

    def _between(self):
        """Samples lie between rows, at the time they say; what contradicts that."""
        tick, reasons = self.truth["tick_s"], []
        t = self.t[0] + self.time - self.time[0]
        least = int((self.t[-1] - self.t[0]) / self.period) - self.loose
        if not least <= len(t) <= least + 2 + self.loose or t[-1] > self.t[-1] + tick + self.period:
            return [f"{len(t)} samples of {self.period} s instead of {least + 1}"]
        left = np.clip(np.searchsorted(self.t, t + tick, "right") - 1, 0, len(self.t) - 2)
        gap = self.t[left + 1] - self.t[left]
        for signal in self.truth["signals"]:
            name, y, of = signal["name"], self.values[signal["name"]], signal["of"]
            found = self.read[name]
            if signal["held"]:
                reasons += self._held(name, found, y, t, tick + self.late, signal["quantum"])
                continue
            allowed = of.curvature() * gap**2 / 8.0 + of.slope() * (2.0 * tick + 2.0 * self.late)
            allowed += 0.5 * signal["quantum"] + SIGMAS * signal["noise"]
            expected = of.at(t)
            holes = np.isnan(y[left]) | np.isnan(y[left + 1])
            holes |= np.isnan(y[np.maximum(left - 1, 0)])
            expected[holes & np.isnan(found)] = np.nan
            reasons += self._compared(name, found, expected, allowed, np.arange(len(t)))
        return reasons

    def _held(self, name, found, y, t, slack, quantum):
        """An input lies between the levels around it."""
        first = np.searchsorted(self.t, t - slack) - 1
        last = np.searchsorted(self.t, t + self.period + slack)
        first, last = np.maximum(first, 0), np.minimum(last, len(y) - 1)
        low, high, hole = y[first].copy(), y[first].copy(), np.isnan(y[first])
        for ahead in range(1, int((last - first).max()) + 1):
            more = y[np.minimum(first + ahead, last)]
            hole |= np.isnan(more)
            low, high = np.fmin(low, more), np.fmax(high, more)
        nearest = np.clip(found, low - quantum, high + quantum)
        nearest[hole & np.isnan(found)] = np.nan
        return self._compared(name, found, nearest, quantum, np.arange(len(t)))

    def _compared(self, name, found, expected, allowed, place):
        same = np.isnan(found) & np.isnan(expected)
        off = np.where(same, 0.0, np.abs(found - expected)) / allowed
        off[np.isnan(off)] = np.inf
        if not len(off) or off.max() <= 1.0:
            return []
        k, count = int(np.argmax(off > 1.0)), int((off > 1.0).sum())
        return [
            f"{name}: {count} of {len(found)} samples off, sample {place[k]} is {found[k]:.6g}"
            f" instead of {expected[k]:.6g} (allowed {np.broadcast_to(allowed, off.shape)[k]:.2g})"
        ]
