"""A random telegraph: two levels, changed at random times."""

import numpy as np


class Telegraph:
    def __init__(self, rng, sd, slow, h):
        self.rng, self.chance = rng, 0.5 * -np.expm1(-h / slow)
        self.value = sd * rng.choice([-1.0, 1.0], size=len(sd))

    def __call__(self):
        now = self.value
        turns = self.rng.random(len(now)) < self.chance
        self.value = np.where(turns, -now, now)
        return now
