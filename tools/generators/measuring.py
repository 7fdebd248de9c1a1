"""From true signals to what a data logger writes: sensor errors, noise, quantisation; and loads."""

import numpy as np

LEVELS = {
    #         share of the greatest value: speed, current; theta and x by their own
    "none": (0.0, 0.0),
    "small": (0.001, 0.0015),
    "medium": (0.003, 0.005),
    "large": (0.01, 0.015),
}
QUANTA = (0.0, 0.5, 1.5)
"""Quantisation steps in units of the noise's standard deviation; drawn."""


def seen(trace, hidden):
    """Signals as the sensors show them, without noise. `hidden` holds one value a machine."""
    omega = np.where(hidden["lag"] > 0.0, trace.shown, trace.w)
    omega = omega * (1.0 + hidden["gain"] + hidden["depth"] * np.cos(trace.theta + hidden["phase"]))
    return {"i": trace.i + hidden["offset"], "omega": omega, "theta": trace.theta}


def noisy(rng, values, share):
    """One machine's signal with noise and quantisation; the noise's standard deviation."""
    sd = share * np.abs(values).max()
    quantum = sd * rng.choice(QUANTA)
    values = values + sd * rng.standard_normal(len(values))
    if quantum > 0.0:
        values = np.round(values / quantum) * quantum
    return values, float(np.hypot(sd, quantum / np.sqrt(12.0)))


class ColouredLoad:
    """Ornstein-Uhlenbeck load torques, exact from sub-step to sub-step."""

    def __init__(self, rng, sd, slow, h):
        self.rng, self.sd = rng, sd
        self.stay = np.exp(-h / slow)
        self.kick = sd * np.sqrt(-np.expm1(-2.0 * h / slow))
        self.value = sd * rng.standard_normal(len(sd))

    def __call__(self, sample, substep):
        now = self.value
        self.value = self.stay * now + self.kick * self.rng.standard_normal(len(now))
        return now
