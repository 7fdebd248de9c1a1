"""A sine in time: a pump or a press beside the machine. One period is two time constants."""

import numpy as np


class Sine:
    def __init__(self, rng, sd, slow, h):
        self.height, self.rate = np.sqrt(2.0) * sd, np.pi * h / slow
        self.phase = rng.uniform(0.0, 2 * np.pi, size=len(sd))

    def __call__(self):
        now = self.height * np.sin(self.phase)
        self.phase = self.phase + self.rate
        return now
