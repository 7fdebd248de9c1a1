"""Sampled controllers: PI of the speed, PD of the position; u is recorded.

Each machine has its own sampling time, in ticks of the common clock. Gains place the poles of the
rigid machine as far out as the sampling allows. Most of the dry friction is fed forward, as servo
drives do: at low speed a controller alone would stick.
"""

import numpy as np

from .balance import THETA, W

FASTEST = 40.0
"""Bandwidth of a loop that no sampling limits, rad/s."""
OF_SAMPLING = 0.15
"""Bandwidth times sampling time."""
FED_FORWARD = 0.8
"""Share of the dry friction."""
CURRENTS = 3.0
"""Greatest current of a current loop, times the rated."""


class Controllers:
    """u of all machines: open loops from their shares, closed ones from what their sensors show."""

    def __init__(self, machines, force, modes, asked, every, tick, noise, rng):
        """`asked` (ticks, machines); `every`: ticks between samples; `noise`: that of the shown
        speed, a share of the top speed."""
        self.samples = len(asked)
        self.asked, self.every, self.rng = asked, every, rng
        self.speed, self.position = modes == "speed", modes == "position"
        m, self.period = machines, every * tick
        self.top, self.sd = m.top_speed, noise * m.top_speed
        band = np.minimum(FASTEST, OF_SAMPLING / self.period)
        slow = m.J * m.R / m.K**2
        # Of a voltage, back-EMF brakes; of a current, nothing does.
        self.kp = np.where(force, m.J * band / m.K, m.K * slow * band)
        self.ki = np.where(force, 0.25 * self.kp * band, m.K * band)
        self.dry = FED_FORWARD * m.T_c / m.K * np.where(force, 1.0, m.R)
        self.pull = np.where(force, m.J * band**2 / m.K, m.K * slow * band**2)
        damp = np.maximum(2.0 * slow * band - 1.0, 0.2)
        self.damp = np.where(force, 2.0 * m.J * band / m.K, m.K * damp)
        self.ahead = np.where(force, 0.0, m.K)
        self.unit = np.where(force, 1.0, m.volts)
        self.limit = np.where(force, CURRENTS * m.amps, m.volts)
        self.sum = np.zeros(len(force))
        self.u = np.zeros(len(force))

    def __call__(self, k, x):
        due = k % self.every == 0
        if not due.any():
            return self.u
        asked = self.asked[k]
        w = x[W] + self.sd * self.rng.standard_normal(len(due))
        off = asked * self.top - w
        dry = self.dry * np.sign(asked)
        wished = self.kp * off + self.sum + self.ki * self.period * off + dry
        free = due & self.speed & (np.abs(wished) < self.limit)
        self.sum = np.where(free, self.sum + self.ki * self.period * off, self.sum)
        later = np.minimum(k + self.every, self.samples - 1)
        rate = (self.asked[later, np.arange(len(due))] - asked) / self.period
        moved = self.pull * (asked - x[THETA]) + self.damp * (rate - w) + self.ahead * rate
        moved = moved + self.dry * np.sign(rate)
        u = np.where(self.speed, wished, np.where(self.position, moved, asked * self.unit))
        u = np.clip(u, -self.limit, self.limit)
        # What a converter puts out has steps.
        step = self.limit / 2**13
        self.u = np.where(due, np.round(u / step) * step, self.u)
        return self.u
