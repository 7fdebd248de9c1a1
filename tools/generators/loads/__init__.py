"""Load torques that nobody records, of several kinds: one a file, and its line in `KINDS`.

A kind is made with (rng, sd, slow, h): standard deviations and time constants, one a machine, and
the time between calls; a call gives the torque of every machine now.
"""

import numpy as np

from .ornstein_uhlenbeck import OrnsteinUhlenbeck
from .oscillation import Oscillation
from .random_walk import RandomWalk
from .shots import Shots
from .sine import Sine
from .telegraph import Telegraph

KINDS = {
    "ornstein_uhlenbeck": OrnsteinUhlenbeck,
    "random_walk": RandomWalk,
    "telegraph": Telegraph,
    "shots": Shots,
    "oscillation": Oscillation,
    "sine": Sine,
}


class Loads:
    """Machines with loads of different kinds, or none; changes from tick to tick."""

    def __init__(self, rng, kinds, sd, slow, tick):
        self.value = np.zeros(len(kinds))
        self.parts = []
        for name, kind in KINDS.items():
            lanes = np.flatnonzero(np.asarray(kinds) == name)
            if len(lanes):
                self.parts.append((lanes, kind(rng, sd[lanes], slow[lanes], tick)))

    def __call__(self, sample, substep):
        if substep == 0:
            for lanes, part in self.parts:
                self.value[lanes] = part()
        return self.value
