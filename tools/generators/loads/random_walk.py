"""A random walk: never comes back. Its standard deviation is `sd` after `WALK` time constants."""

import numpy as np

WALK = 20.0


class RandomWalk:
    def __init__(self, rng, sd, slow, h):
        self.rng, self.kick = rng, sd * np.sqrt(h / (WALK * slow))
        self.value = np.zeros(len(sd))

    def __call__(self):
        now = self.value
        self.value = now + self.kick * self.rng.standard_normal(len(now))
        return now
