"""The balances of voltage and torque, for all machines at once.

    L di/dt = supply u - R resistance i - K flux w - drop
    J dw/dt = K flux i - B w - load - torque - dry friction

Laws write into a `Total`. A force-driven axis has no electrical state: its i is u.
"""

from dataclasses import dataclass

import numpy as np

I, W, THETA, WARM, CASE, BRISTLE, FAR, TWIST, SHOWN = range(9)  # noqa: E741
"""Rows of the state: current, speed, angle, relative resistance of the winding by its heat and the
part of it which the case holds, bristle deflection, speed and twist of a far inertia, speed shown.
"""
STATES = 9


@dataclass
class View:
    """What a law sees."""

    i: np.ndarray
    w: np.ndarray
    theta: np.ndarray
    u: np.ndarray
    time: float
    warm: np.ndarray
    drive: np.ndarray
    """K i, the torque of the current."""


@dataclass
class Total:
    """What laws add up to; the levels of dry friction are those of either direction."""

    torque: np.ndarray
    forward: np.ndarray
    backward: np.ndarray
    drop: np.ndarray
    flux: np.ndarray
    resistance: np.ndarray
    supply: np.ndarray

    @classmethod
    def start(cls, machine):
        n = len(machine.R)
        one, zero = np.ones(n), np.zeros(n)
        level = machine.T_c
        return cls(zero.copy(), level.copy(), level.copy(), zero, one, one.copy(), one.copy())


@dataclass
class Bench:
    """Machines with what hides in them. Arrays have one entry a machine."""

    machine: object
    laws: list
    """Pairs of a law's function and its parameters."""
    creep: np.ndarray
    """Speed scale of a smoothed zero-speed law, rad/s; 0: the shaft sticks (Karnopp)."""
    force: bool | np.ndarray = False
    """Whether u is the current; one value a machine where they differ."""
    bristle: np.ndarray | None = None
    """Deflection at which the bristles slip, rad; 0: none."""
    heating: tuple | None = None
    """Relative rise of resistance a second at unit current squared, time constant, s."""
    far: tuple | None = None
    """Share of the inertia that is far, stiffness, damping, half the play; share 0: none."""
    lag: np.ndarray | None = None
    """Time constant of the speed sensor, s; 0: none."""


def balance(bench, x, direction, u, load, time):
    """Rates of the states, torque without dry friction, its levels forward and backward."""
    m = bench.machine
    mixed = isinstance(bench.force, np.ndarray)
    i = np.where(bench.force, u, x[I]) if mixed else u if bench.force else x[I]
    w, theta = x[W], x[THETA]
    total = Total.start(m)
    view = View(i, w, theta, u, time, x[WARM], m.K * i)
    for add, parameters in bench.laws:
        add(total, view, parameters)
    rate = np.zeros_like(x)
    rate[THETA] = w
    if mixed or not bench.force:
        resistance = m.R * (total.resistance + x[WARM])
        rate[I] = (total.supply * u - resistance * i - m.K * total.flux * w - total.drop) / m.L
        if mixed:
            rate[I] = np.where(bench.force, 0.0, rate[I])
    free = m.K * total.flux * i - m.B * w - total.torque
    inertia = m.J
    if bench.far is None:
        free = free - load
    else:
        share, stiffness, damping, play = bench.far
        apart = share > 0.0
        stretch = np.sign(x[TWIST]) * np.maximum(np.abs(x[TWIST]) - play, 0.0)
        touching = np.abs(x[TWIST]) >= play
        # A spring that hardens by a few per cent: not quite the linear one.
        shaft = stiffness * stretch * (1.0 + 0.05 * np.tanh(np.abs(stretch) / (play + 0.02)))
        shaft = apart * (shaft + touching * damping * (w - x[FAR]))
        free = free - np.where(apart, shaft, load)
        inertia = m.J * (1.0 - share)
        rate[FAR] = apart * (shaft - load) / (m.J * np.where(apart, share, 1.0))
        rate[TWIST] = apart * (w - x[FAR])
    level = np.where(direction >= 0.0, total.forward, total.backward)
    dry = level * direction
    soft = bench.creep > 0.0
    if soft.any():
        bent = np.tanh(w / np.where(soft, bench.creep, 1.0))
        either = np.where(w >= 0.0, total.forward, total.backward)
        dry = np.where(soft, either * bent, dry)
    if bench.bristle is not None:
        bristled = bench.bristle > 0.0
        bent = x[BRISTLE] / np.where(bristled, bench.bristle, 1.0)
        either = np.where(bent >= 0.0, total.forward, total.backward)
        dry = np.where(bristled, either * bent, dry)
        left = np.clip(1.0 - np.sign(w) * bent, 0.0, 2.0)
        # Dahl with exponent 1.3; the library's has 1.
        rate[BRISTLE] = bristled * w * left**1.3
    rate[W] = (free - dry) / inertia
    if bench.heating is not None:
        rise, slow = bench.heating
        rate[WARM] = rise * i * i - (x[WARM] - x[CASE]) / slow
        rate[CASE] = (x[WARM] - x[CASE]) / (4.0 * slow) - x[CASE] / (15.0 * slow)
    if bench.lag is not None:
        rate[SHOWN] = np.where(bench.lag > 0.0, (w - x[SHOWN]) / np.maximum(bench.lag, 1e-9), 0.0)
    return rate, free, total.forward, total.backward
