"""Time: Runge-Kutta steps ten times finer than the samples, and a shaft that sticks.

Stick-slip after Karnopp with an interpolated crossing. Over a step the direction of dry friction is
held. A shaft whose speed changed its sign stops if the other torques do not exceed the break-away
level; otherwise it goes on in the other direction for what is left of the step, from rest.
"""

from dataclasses import dataclass

import numpy as np

from .balance import SHOWN, STATES, THETA, I, W, balance

SUBSTEPS = 10


@dataclass
class Trace:
    """True signals at the samples, (samples, machines); current, speed, angle, shown speed."""

    u: np.ndarray
    i: np.ndarray
    w: np.ndarray
    theta: np.ndarray
    shown: np.ndarray


def advance(bench, x, direction, u, load, time, h):
    """State and direction of dry friction after `h` seconds."""
    hard = bench.creep == 0.0
    if bench.bristle is not None:
        hard &= bench.bristle == 0.0

    def rate(state, t):
        found, *_ = balance(bench, state, direction, u, load, t)
        found[W] = np.where(held, 0.0, found[W])
        return found

    held = hard & (direction == 0.0)
    k1, free, forward, backward = balance(bench, x, direction, u, load, time)
    if held.any():
        # Released by what acts now, not by what acted at the end of the last step.
        breaks = held & np.where(free >= 0.0, free > forward, -free > backward)
        if breaks.any():
            direction = np.where(breaks, np.sign(free), direction)
            held = held & ~breaks
            k1 = rate(x, time)
        k1[W] = np.where(held, 0.0, k1[W])
    k2 = rate(x + 0.5 * h * k1, time + 0.5 * h)
    k3 = rate(x + 0.5 * h * k2, time + 0.5 * h)
    k4 = rate(x + h * k3, time + h)
    new = x + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    crossed = hard & (direction != 0.0) & (new[W] * direction < 0.0)
    if not crossed.any():
        return new, direction
    left = np.where(crossed, new[W] / np.where(crossed, new[W] - x[W], 1.0), 0.0)
    new[W] = np.where(crossed, 0.0, new[W])
    _, free, forward, backward = balance(bench, new, direction, u, load, time + h)
    goes = crossed & np.where(free >= 0.0, free > forward, -free > backward)
    direction = np.where(crossed, np.where(goes, np.sign(free), 0.0), direction)
    if goes.any():
        onward, *_ = balance(bench, new, direction, u, load, time + h)
        new[W] = np.where(goes, left * h * onward[W], new[W])
    return new, direction


def run(bench, u, load, period, delay=None, substeps=SUBSTEPS):
    """Runs all machines from rest; `u` (samples, machines) is held from sample to sample.

    `load` is a function of (sample, sub-step) that gives the load torque of every machine; `u` may
    be a function of the sample and the state instead (a controller). `delay`: by how many
    seconds u comes late, less than a period, one value a machine.
    """
    n = len(bench.machine.R)
    controlled = callable(u)
    samples = u.samples if controlled else len(u)
    h = period / substeps
    x, direction = np.zeros((STATES, n)), np.zeros(n)
    late = np.zeros(n) if delay is None else np.round(np.asarray(delay) / h)
    kept = np.empty((5, samples, n))
    before = np.zeros(n)
    for k in range(samples):
        now = u(k, x) if controlled else u[k]
        kept[:, k] = now, np.where(bench.force, now, x[I]), x[W], x[THETA], x[SHOWN]
        for j in range(substeps):
            applied = np.where(j >= late, now, before)
            time = (k * substeps + j) * h
            x, direction = advance(bench, x, direction, applied, load(k, j), time, h)
        before = now
    return Trace(*kept)
