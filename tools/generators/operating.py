"""Operating points: where and how a machine is run while it is recorded.

Each gives what is asked for at the samples: a share of the supply voltage (`open`), a speed as a
share of the top speed (`speed`), or a position (`position`), by which the loop is closed.
"""

import numpy as np

from . import excitation

TRAVEL_S = 0.5
"""Longest move of a position loop: what the top speed covers in that time."""


def _profile(rng, t):
    """A profile within -1 and 1: steps, ramps, sines in turn."""
    wave = excitation.voltage(rng, len(t), t[1] - t[0])
    return wave / max(1e-6, np.abs(wave).max())


def open_loop(rng, t, m):
    """The whole range, both ways."""
    return "open", excitation.voltage(rng, len(t), t[1] - t[0])


def one_direction(rng, t, m):
    """Never back, and never at rest but for the start."""
    middle = rng.uniform(0.35, 0.6) * rng.choice([-1.0, 1.0])
    return "open", middle * (1.0 + 0.6 * _profile(rng, t))


def high_speed(rng, t, m):
    """Near the top speed."""
    return "open", rng.choice([-1.0, 1.0]) * (0.8 + 0.15 * _profile(rng, t))


def around_rest(rng, t, m):
    """A voltage about that of break-away: the shaft sticks and slips."""
    away = m.T_c * m.R / m.K / m.volts
    return "open", np.clip(rng.uniform(2.0, 4.0) * away * _profile(rng, t), -1.0, 1.0)


def speed_loop(rng, t, m):
    """A speed controller follows a profile over much of the range."""
    return "speed", rng.uniform(0.4, 0.7) * _profile(rng, t)


def low_speed(rng, t, m):
    """A speed controller at a few per cent of the top speed."""
    return "speed", rng.uniform(0.01, 0.04) * _profile(rng, t)


def one_way_loop(rng, t, m):
    """A speed controller in one direction."""
    return "speed", rng.choice([-1.0, 1.0]) * (0.4 + 0.2 * _profile(rng, t))


def position_loop(rng, t, m):
    """A position controller follows smooth moves and rests."""
    period, path, here = t[1] - t[0], [], 0.0
    while sum(map(len, path)) < len(t):
        there = m.top_speed * TRAVEL_S * rng.uniform(-0.3, 0.3)
        # The peak of a minimum-jerk move is 1.9 times its mean speed.
        lasts = max(0.15, 1.9 * abs(there - here) / (rng.uniform(0.2, 0.5) * m.top_speed))
        x = np.arange(1, max(2, int(lasts / period)) + 1)
        x = x / len(x)
        path.append(here + (there - here) * x**3 * (10 - 15 * x + 6 * x**2))
        path.append(np.full(max(1, int(rng.uniform(0.05, 0.2) / period)), there))
        here = there
    return "position", np.concatenate(path)[: len(t)]


BY_VOLTAGE = (
    open_loop,
    one_direction,
    high_speed,
    around_rest,
    speed_loop,
    low_speed,
    position_loop,
)
BY_CURRENT = (speed_loop, low_speed, one_way_loop, position_loop)
"""A current that nobody controls by a speed runs away."""
