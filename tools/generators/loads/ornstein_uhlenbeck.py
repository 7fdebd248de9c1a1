"""Ornstein-Uhlenbeck: forgets within its time constant."""

import numpy as np


class OrnsteinUhlenbeck:
    def __init__(self, rng, sd, slow, h):
        self.rng, self.stay = rng, np.exp(-h / slow)
        self.kick = sd * np.sqrt(-np.expm1(-2.0 * h / slow))
        self.value = sd * rng.standard_normal(len(sd))

    def __call__(self):
        now = self.value
        self.value = self.stay * now + self.kick * self.rng.standard_normal(len(now))
        return now
