"""Clean recordings: every signal a known function of time."""

from dataclasses import dataclass, field

import numpy as np

HELD_SAMPLES = 90
"""Samples over which an input keeps its level, at least."""


@dataclass
class Signal:
    """A sum of sines (`amplitudes`, `rates` in rad/s, `phases`) on an `offset`, SI; with white
    noise of standard deviation `noise`. An input is `held`: its value belongs to the sample."""

    name: str
    unit: str
    offset: float = 0.0
    amplitudes: list = field(default_factory=list)
    rates: list = field(default_factory=list)
    phases: list = field(default_factory=list)
    noise: float = 0.0
    held: bool = False

    def at(self, t):
        """Its value without noise, at any times."""
        waves = zip(self.amplitudes, self.rates, self.phases, strict=True)
        return self.offset + sum(a * np.sin(w * np.asarray(t) + p) for a, w, p in waves)

    def largest(self):
        return abs(self.offset) + sum(self.amplitudes)

    def slope(self):
        """Bound of the first derivative."""
        return sum(a * w for a, w in zip(self.amplitudes, self.rates, strict=True))

    def slope_rms(self):
        squares = (0.5 * (a * w) ** 2 for a, w in zip(self.amplitudes, self.rates, strict=True))
        return sum(squares) ** 0.5

    def curvature(self):
        """Bound of the second derivative."""
        return sum(a * w * w for a, w in zip(self.amplitudes, self.rates, strict=True))


#        name: sampling time in s, seconds, signals (name, unit, largest, offset)
KINDS = {
    "motor": (1e-3, 3.0, [("u", "V", 12.0, 0), ("i", "A", 4.0, 0), ("omega", "rad/s", 250.0, 0)]),
    "angle": (1e-3, 3.0, [("u", "V", 12.0, 0), ("theta", "rad", 20.0, 0)]),
    "axis": (5e-4, 1.5, [("u", "V", 5.0, 0), ("x", "m", 0.12, 0.3)]),
    "torque": (
        1e-2,
        28.0,
        [("torque", "N m", 1.6, 0), ("omega", "rad/s", 200.0, 0), ("temperature", "K", 9.0, 320.0)],
    ),
    "tachometer": (1.0 / 62.0, 42.0, [("C_m", "V", 8.0, 0), ("T", "rpm", 2500.0, 0)]),
    "epoch": (5e-3, 15.0, [("u", "V", 24.0, 0), ("i", "A", 9.0, 0), ("omega", "rad/s", 300.0, 0)]),
}


@dataclass
class Clean:
    """A recording before anything happened to it."""

    kind: str
    period: float
    t: np.ndarray
    signals: list
    levels: dict
    """Of every held signal, its value a sample."""


def make(rng, kind):
    """A recording of that kind with waves of its own."""
    period, seconds, columns = KINDS[kind]
    samples = round(seconds * rng.uniform(0.8, 1.2) / period)
    signals, levels = [], {}
    for name, unit, largest, offset in columns:
        if name in ("u", "C_m"):
            signals.append(Signal(name, unit, amplitudes=[largest], rates=[0.0], phases=[0.0]))
            signals[-1].held = True
            levels[name] = _levels(rng, samples, largest)
        else:
            signals.append(_waves(rng, name, unit, largest, offset, period))
    return Clean(kind, period, np.arange(samples) * period, signals, levels)


def _waves(rng, name, unit, largest, offset, period):
    """Waves of 100 samples and more, most of the height in those of 600 and more."""
    shares = np.array([0.55, 0.3, 0.15]) * rng.uniform(0.8, 1.0, 3)
    samples = np.array([rng.uniform(1200, 2500), rng.uniform(500, 1000), rng.uniform(100, 200)])
    signal = Signal(name, unit, offset, (largest * shares).tolist())
    signal.rates = (2 * np.pi / (samples * period)).tolist()
    signal.phases = rng.uniform(0, 2 * np.pi, 3).tolist()
    signal.noise = largest * float(rng.choice([0.0, 5e-4, 3e-3]))
    return signal


def _levels(rng, samples, largest):
    """Steps between a few levels."""
    levels = np.empty(samples)
    at = 0
    while at < samples:
        until = at + int(rng.integers(HELD_SAMPLES, 4 * HELD_SAMPLES))
        levels[at:until] = round(largest * rng.uniform(-1.0, 1.0), 2)
        at = until
    return levels
