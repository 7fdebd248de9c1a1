"""Shots: blows at random times, of either sign, that fade within the time constant.

With a rate of r blows a second of height a, the variance is a^2 r slow / 2; a blow comes every ten
time constants.
"""

import numpy as np

RARE = 10.0


class Shots:
    def __init__(self, rng, sd, slow, h):
        self.rng, self.stay, self.chance = rng, np.exp(-h / slow), h / (RARE * slow)
        self.height = sd * np.sqrt(2.0 * RARE)
        self.value = np.zeros(len(sd))

    def __call__(self):
        now = self.value
        n = len(now)
        hit = self.rng.random(n) < self.chance
        blow = self.height * self.rng.choice([-1.0, 1.0], size=n)
        self.value = self.stay * now + np.where(hit, blow, 0.0)
        return now
