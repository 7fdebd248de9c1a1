"""Reference data for the tests of the diagnoser, by other people's code.

Three steps, the last two in environments of their own (`gmdh` needs numpy < 2):

    python generate.py data             # numpy
    python generate.py arx              # pip install SIPPY-unipi==1.0.1
    python generate.py gmdh             # pip install gmdh==1.0.3 "numpy<2"

`data` simulates a small DC motor with dry friction: `closed_loop.csv` under PI speed control at
2000 rpm, `open_loop.csv` under three sines; columns u [V], y [rpm]. `arx` writes
`arx_sippy.csv` (a_1..a_20, b_1..b_20, no constant), `gmdh` writes `gmdh_pypi.csv`: the test
error of every algorithm of the package, one step ahead from y(k-1), y(k-2), u(k-1), u(k-2),
fitted on the first 1000 equations and tested on the rest.
"""

import sys
from math import exp, pi, sin, sqrt, tanh
from pathlib import Path

HERE = Path(__file__).parent
PERIOD = 0.005
ORDER = 20
FITTED = 1000


class Motor:
    """2.4 V/V amplifier, R = 3 ohm, L = 4 mH, K = 0.06, J = 8e-5, dry and viscous friction."""

    def __init__(self):
        self.i = self.omega = self.load = 0.0

    def hold(self, control, shock):
        kept = exp(-PERIOD / 0.05)
        self.load = kept * self.load + 1e-3 * sqrt(1.0 - kept * kept) * shock
        h = PERIOD / 50
        for _ in range(50):
            self.i += h / 0.004 * (2.4 * control - 3.0 * self.i - 0.06 * self.omega)
            friction = 0.016 * tanh(self.omega / 2.0) + 6e-5 * self.omega
            self.omega += h / 8e-5 * (0.06 * self.i - friction - self.load)
        return self.omega * 30.0 / pi


def data():
    import numpy as np

    draw = np.random.default_rng(1).standard_normal
    motor, shaft, integral, rows = Motor(), 0.0, 0.0, []
    for sensor, reference, shock in draw((3500, 3)):
        y = shaft + 3.0 * sensor
        error = 2000.0 + 20.0 * reference - y
        u = max(-10.0, min(10.0, 0.004 * error + integral))
        integral += 0.05 * PERIOD * error
        rows.append((u, y))
        shaft = motor.hold(u, shock)
    write("closed_loop.csv", "u,y", (f"{u:.5f},{y:.3f}" for u, y in rows[500:]))
    motor, shaft, rows = Motor(), 0.0, []
    for k, (sensor, shock) in enumerate(draw((1502, 2))):
        t = k * PERIOD
        sines = ((1.7, 0.0), (1.1, -pi / 7.0), (0.3, pi / 3.0))
        u = sum(3.0 * sin(2.0 * pi * f * t + phase) for f, phase in sines)
        rows.append((u, shaft + 3.0 * sensor))
        shaft = motor.hold(u, shock)
    write("open_loop.csv", "u,y", (f"{u:.5f},{y:.3f}" for u, y in rows))


def arx():
    from sippy_unipi import system_identification

    u, y = read("closed_loop.csv")
    model = system_identification(y, u, "ARX", ARX_orders=[[ORDER], [[ORDER]], [[0]]])
    numerator, denominator = (
        [float(c) for c in model.G.num[0][0]],
        [float(c) for c in model.G.den[0][0]],
    )
    a = denominator[1 : ORDER + 1]
    b = ([0.0] * ORDER + numerator)[-ORDER:]
    write("arx_sippy.csv", "a,b", (f"{a!r},{b!r}" for a, b in zip(a, b)))


def gmdh():
    import gmdh as package
    import numpy as np

    u, y = (np.array(column) for column in read("open_loop.csv"))
    x = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]])
    target = y[2:]
    rows = []
    for name in ("Combi", "Multi", "Mia", "Ria"):
        model = getattr(package, name)()
        model.fit(x[:FITTED], target[:FITTED])
        error = np.asarray(model.predict(x[FITTED:])) - target[FITTED:]
        rows.append(f"{name},{float(np.sqrt(np.mean(error**2)))!r}")
    write("gmdh_pypi.csv", "algorithm,test_rms", rows)


def read(name):
    lines = (HERE / name).read_text().split()[1:]
    return zip(*([float(field) for field in line.split(",")] for line in lines))


def write(name, head, lines):
    (HERE / name).write_text("\n".join([head, *lines]) + "\n")


if __name__ == "__main__":
    {"data": data, "arx": arx, "gmdh": gmdh}[sys.argv[1]]()
