"""A damped oscillation that is kicked at random: something elastic in the foundation.

One turn of its phase takes a time constant, and it forgets its phase within three.
"""

import numpy as np

TURNS = 3.0


class Oscillation:
    def __init__(self, rng, sd, slow, h):
        self.rng = rng
        self.turn = np.exp(2j * np.pi * h / slow - h / (TURNS * slow))
        self.kick = sd * np.sqrt(1.0 - np.abs(self.turn) ** 2)
        self.value = sd * self._draw(len(sd))

    def _draw(self, n):
        return self.rng.standard_normal(n) + 1j * self.rng.standard_normal(n)

    def __call__(self):
        now = self.value
        self.value = self.turn * now + self.kick * self._draw(len(now))
        return now.real
