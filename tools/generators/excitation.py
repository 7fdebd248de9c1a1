"""What a bench applies: steps, staircases, slow ramps, reversals, multisine and chirp, in turn.

Every recording holds a slow passage through zero speed and steps in both directions; what else,
in which order, how long and how high is drawn.
"""

import numpy as np


def _held(rng, t, levels, dwell):
    """Levels held for random times around `dwell` seconds."""
    edges = np.cumsum(rng.uniform(0.6, 1.4, size=len(levels)) * dwell)
    edges *= t[-1] / edges[-1]
    return np.asarray(levels)[np.minimum(np.searchsorted(edges, t), len(levels) - 1)]


def steps(rng, t):
    dwell = rng.uniform(0.15, 0.4)
    count = max(3, int(t[-1] / dwell))
    signs = np.where(np.arange(count) % 2 == rng.integers(2), 1.0, -1.0)
    return _held(rng, t, signs * rng.uniform(0.15, 0.6, size=count), dwell)


def staircase(rng, t):
    top = rng.uniform(0.35, 0.65)
    half = np.linspace(0.0, top, rng.integers(4, 7))
    levels = np.concatenate([half, half[-2::-1], -half[1:], -half[-2::-1]])
    return _held(rng, t, levels * rng.choice([-1.0, 1.0]), t[-1] / len(levels))


def slow_ramp(rng, t):
    """A triangle: a slow passage through zero in both directions."""
    height, phase = rng.uniform(0.2, 0.45), rng.uniform(0.0, 1.0)
    turns = rng.uniform(0.8, 1.6)
    x = np.mod(turns * t / t[-1] + phase, 1.0)
    return height * (4.0 * np.abs(x - 0.5) - 1.0)


def reversals(rng, t):
    rate = rng.uniform(0.6, 2.0)
    return rng.uniform(0.25, 0.5) * np.sin(2 * np.pi * rate * t + rng.uniform(0, 2 * np.pi))


def multisine(rng, t):
    rates = np.geomspace(0.7, 40.0, 12) * rng.uniform(0.9, 1.1, size=12)
    phases = rng.uniform(0.0, 2 * np.pi, size=12)
    wave = np.sin(2 * np.pi * rates * t[:, None] + phases).sum(axis=1)
    return rng.uniform(-0.2, 0.2) + rng.uniform(0.3, 0.55) * wave / np.abs(wave).max()


def chirp(rng, t):
    low, high = rng.uniform(0.5, 1.5), rng.uniform(15.0, 50.0)
    growth = np.log(high / low) / t[-1]
    phase = 2 * np.pi * low * np.expm1(growth * t) / growth
    return rng.uniform(-0.15, 0.15) + rng.uniform(0.25, 0.45) * np.sin(phase)


SLOW = (slow_ramp, reversals)
SWITCHED = (steps, staircase)
OTHERS = (multisine, chirp, steps, staircase, slow_ramp)


def voltage(rng, samples, period):
    """One recording's input as a share of the supply voltage, one value a sample."""
    others = rng.choice(len(OTHERS), size=rng.integers(1, 3))
    kinds = [slow_ramp, SLOW[rng.integers(2)], SWITCHED[rng.integers(2)]]
    kinds += [OTHERS[k] for k in others]
    order = rng.permutation(len(kinds))
    share = rng.uniform(0.7, 1.3, size=len(kinds))
    # The slow passages need time.
    share[:2] *= 1.6
    lengths = (share / share.sum() * samples).astype(int)
    lengths[order[-1]] += samples - lengths.sum()
    parts = [kinds[k](rng, np.arange(lengths[k]) * period) for k in order]
    return np.clip(np.concatenate(parts), -1.0, 1.0)
