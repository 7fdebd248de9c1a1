"""What is recorded of a machine: which channels, with which skew in time, from which sensor."""

from dataclasses import dataclass

import numpy as np

from .measuring import LEVELS, noisy

BY_VOLTAGE = (
    # (columns beside u, how the speed is made)
    (("i", "omega"), "sensor"),
    (("i", "omega"), "sensor"),
    (("i", "omega"), "sensor"),
    (("i", "omega"), "differences"),
    (("omega",), "sensor"),
    (("i", "theta"), None),
    (("theta",), None),
)
BY_CURRENT = (
    (("omega",), "sensor"),
    (("omega",), "differences"),
    (("omega", "theta"), "sensor"),
    (("theta",), None),
)
LINES = (1000, 2048, 4096, 10_000, 65_536)
"""Counts of an encoder a turn of the motor."""
SKEWED = 0.25
"""Share of the machines whose speed comes late."""
SKEW = (0.3, 3.0)
"""By how many samples."""


@dataclass
class Sensors:
    """How one machine is seen."""

    columns: tuple
    speed_from: str | None
    """`sensor`, or `differences` of the encoder's position; None where no speed is recorded."""
    step: float
    """Step of the encoder, rad or m of the shaft that is recorded."""
    skew: float
    """Seconds by which the motion comes later than current and u."""


def draw(rng, by_voltage, travel, period):
    """`travel`: of the recorded shaft for a radian of the motor."""
    choices = BY_VOLTAGE if by_voltage else BY_CURRENT
    columns, speed_from = choices[rng.integers(len(choices))]
    step = 2 * np.pi / float(rng.choice(LINES)) * travel
    late = rng.random() < SKEWED
    return Sensors(columns, speed_from, step, float(late * rng.uniform(*SKEW) * period))


def late(t, values, skew):
    """The signal as it was `skew` seconds before, from rest."""
    return np.interp(t - skew, t, values) if skew else values


def differences(theta, step, period):
    """Speed by the difference of two counts."""
    counts = np.round(theta / step)
    return np.diff(counts, prepend=counts[0]) * step / period


def seen(rng, t, signals, sensors, level, names):
    """Columns of a recording, and the noise of each; `signals` are true, without noise.

    `names`: of speed and position in the file. The position is that of the encoder.
    """
    period = t[1] - t[0]
    speed, current = LEVELS[level]
    columns, noise = {"u": signals["u"]}, {}
    theta = late(t, signals["theta"], sensors.skew)
    if "i" in sensors.columns:
        columns["i"], noise["i"] = noisy(rng, signals["i"], current)
    if "omega" in sensors.columns:
        name = names["omega"]
        if sensors.speed_from == "differences":
            columns[name] = differences(theta, sensors.step, period)
            noise[name] = sensors.step / period / np.sqrt(6.0)
        else:
            omega = late(t, signals["omega"], sensors.skew)
            columns[name], noise[name] = noisy(rng, omega, speed)
    if "theta" in sensors.columns:
        name = names["theta"]
        columns[name] = np.round(theta / sensors.step) * sensors.step
        noise[name] = sensors.step / np.sqrt(12.0)
    return columns, noise
