"""What loggers do to rows and their stamps.

Each function changes a [`Log`] and returns what it did, for the truth. They run in the order of
`ORDER`, whatever the order in which they were drawn.
"""

from dataclasses import dataclass, field

import numpy as np

APART = 80
"""Rows between two events: what happens at once cannot be told apart by a person either."""

TICKS_APART = 5
"""Ticks of a slow clock between two events: fewer say nothing of its rate."""


@dataclass
class Log:
    """Rows as a logger has them: sample of the machine, true instant, stamp, run; s."""

    rng: np.random.Generator
    period: float
    sample: np.ndarray
    t: np.ndarray
    stamp: np.ndarray
    run: np.ndarray
    order: np.ndarray = None
    """Rows in the order of the file, some twice; none before they are written."""
    taken: list = field(default_factory=list)
    """Rows at which something happens."""
    numbered: bool = False
    instants: bool = False
    """Whether rows were sampled when their stamps say, and not evenly."""
    coarse: float = 0.0
    """Step of the stamps, s."""
    latest: float = 0.9
    """How late a stamp may be, in steps, before it looks like that of another sample."""

    def place(self, length=1):
        """A row with nothing near it for `length` rows, inside a run."""
        apart = max(APART, round(TICKS_APART * self.coarse / self.period))
        for _ in range(200):
            row = int(self.rng.integers(apart, len(self.t) - apart - length))
            if all(row + length + apart < a or b + apart < row for a, b in self.taken):
                self.taken.append((row, row + length))
                return row
        return None

    def places(self, most, length=lambda: 1):
        """Up to so many places, and their lengths."""
        found = []
        for _ in range(int(self.rng.integers(1, most + 1))):
            rows = length()
            row = self.place(rows)
            if row is not None:
                found.append((row, rows))
        return sorted(found)

    def keep(self, rows):
        """Only these rows; places of events move along."""
        moved = np.cumsum(rows)
        self.taken = [(int(moved[a]), int(moved[b])) for a, b in self.taken]
        for name in ("sample", "t", "stamp", "run"):
            setattr(self, name, getattr(self, name)[rows])


def of(clean, rng):
    t = clean.t.copy()
    return Log(rng, clean.period, np.arange(len(t)), t, t.copy(), np.zeros(len(t), int))


def joined_rates(log):
    """The second part at another rate, after a pause."""
    row = log.place()
    slower = int(log.rng.choice([2, 4, 5]))
    behind = np.arange(len(log.t)) >= row
    log.run[behind] += 1
    log.t[behind] += 40 * slower * log.period
    log.stamp[:] = log.t
    log.keep(~behind | ((np.arange(len(log.t)) - row) % slower == 0))
    return {"slower": slower}


def jittered_instants(log):
    """Sampled when the stamps say, which is not evenly."""
    share = log.rng.uniform(0.05, 0.45)
    log.t += share * _steps(log) * log.rng.uniform(-1.0, 1.0, len(log.t))
    log.stamp[:] = log.t
    log.instants = True
    return {"share": share}


def jittered_stamps(log):
    """Sampled evenly, stamped when the logger gets to it."""
    share = log.rng.uniform(0.03, 0.4)
    if log.rng.random() < 0.5:
        late = share * log.rng.uniform(-1.0, 1.0, len(log.t))
    else:
        late = np.minimum(0.5 * share * log.rng.exponential(1.0, len(log.t)), log.latest)
    log.stamp += late * _steps(log)
    return {"share": share}


def late_bursts(log):
    """The logger stands still and then stamps what has come meanwhile."""
    bursts = log.places(4, lambda: int(log.rng.integers(4, 40)))
    for row, rows in bursts:
        log.stamp[row : row + rows] = log.stamp[row + rows]
    return {"bursts": len(bursts)}


def lost_samples(log):
    """One or two at a time."""
    count = max(3, int(log.rng.uniform(0.001, 0.02) * len(log.t)))
    there = np.ones(len(log.t), bool)
    for _ in range(count):
        row = int(log.rng.integers(APART, len(log.t) - APART))
        lost = slice(row, row + int(log.rng.integers(1, 3)))
        near = any(a - APART < row < b + APART for a, b in log.taken)
        if not near and there[row - 4 : row + 7].all():
            there[lost] = False
    log.keep(there)
    return {"lost": int((~there).sum())}


def long_gaps(log):
    """The logger was off for a while, and for some ticks of a slow clock."""
    least = max(25, round(2.5 * log.coarse / log.period))
    gaps = log.places(3, lambda: int(log.rng.integers(least, least + 175)))
    there = np.ones(len(log.t), bool)
    for row, rows in gaps:
        there[row : row + rows] = False
        log.run[row + rows :] += 1
    log.keep(there)
    return {"gaps": len(gaps)}


def run_restart(log):
    """Two or three runs end to end, each with a clock from zero."""
    starts = [row for row, _ in log.places(2)]
    for row in starts:
        log.run[row:] += 1
        log.stamp[row:] -= log.stamp[row]
    return {"runs": len(starts) + 1}


def run_number(log):
    """A column that numbers runs; the clock goes on."""
    starts = [row for row, _ in log.places(3)]
    for row in starts:
        log.run[row:] += 1
    log.numbered = True
    return {"runs": len(starts) + 1}


def drawn_tick(log):
    """Whole milliseconds up to whole seconds, so that some samples share one."""
    ticks = [1e-3, 1e-2, 0.1, 1.0]
    whole = abs(log.period * 1e3 - round(log.period * 1e3)) < 1e-9
    fit = [
        tick
        for tick in ticks
        if tick < 80 * log.period
        and tick > (1.5 if whole or tick > 1e-3 else 0.05) * log.period
        and len(log.t) * log.period > 15 * tick
    ]
    return float(log.rng.choice(fit))


def coarse_stamps(log):
    """Stamps of a clock that ticks slowly."""
    # Where a stamp that is a whole number of ticks is meant, rounding must not take one off.
    log.stamp = np.floor(log.stamp / log.coarse + 1e-6) * log.coarse
    return {"tick_s": log.coarse}


def repeated_rows(log):
    """Sent twice, or three times."""
    rows = log.rng.choice(len(log.t), int(log.rng.integers(3, 30)), replace=False)
    log.order = np.sort(np.concatenate([_order(log), rows, rows[:2]]))
    return {"rows": len(rows) + 2}


def disorder(log):
    """Neighbours change places; a row comes a few rows late."""
    order = _order(log).copy()
    moved = log.places(12, lambda: int(log.rng.integers(1, 8)))
    for row, rows in moved:
        at = int(np.searchsorted(_order(log), row))
        order[at : at + rows + 1] = np.roll(order[at : at + rows + 1], -1)
    log.order = order
    return {"rows": len(moved)}


ORDER = [
    joined_rates,
    jittered_instants,
    jittered_stamps,
    late_bursts,
    long_gaps,
    run_restart,
    run_number,
    lost_samples,
    coarse_stamps,
    repeated_rows,
    disorder,
]


def _order(log):
    return np.arange(len(log.t)) if log.order is None else log.order


def _steps(log):
    """Sampling time of each row's part of the log."""
    steps = np.diff(log.t, append=log.t[-1] + log.period)
    return np.minimum(steps, np.roll(steps, 1))
