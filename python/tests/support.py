"""What the tests share: a folder with recordings, and the program to compare with."""

from __future__ import annotations

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import drivescope as ds

PROGRAM = Path(os.environ["DRIVESCOPE_PROGRAM"])

MACHINE = """\
schema = 1
name = "bench"
[motor]
R = 2.0
L = 3e-3
K_e = 0.06
K_m = 0.06
J = 1e-4
B_m = 5e-5
[[effect]]
kind = "coulomb"
T_c = 0.012
[[effect]]
kind = "cogging"
N = 12
a = 0.006
b = 0.0
[noise]
i = 0.005
omega = 0.05
theta = 1e-3
"""
#: The same machine without what `discover` is to find, and off by some per cent.
MODEL = """\
schema = 1
name = "model"
[motor]
R = 2.2
L = 3e-3
K_e = 0.058
K_m = 0.058
J = 1.1e-4
B_m = 5e-5
[[effect]]
kind = "coulomb"
T_c = 0.01
"""
INPUTS = (
    "8 * sin(2 * t) + 5 * sin(7 * t) + 4 * sign(sin(11 * t))",
    "9 * sin(1.7 * t) + 6 * sign(sin(9 * t))",
)


class InFolder(unittest.TestCase):
    """Tests in a folder with a machine, its model and two recordings."""

    @classmethod
    def setUpClass(cls) -> None:
        cls._folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls._folder.cleanup)
        cls.before = os.getcwd()
        os.chdir(cls._folder.name)
        cls.addClassCleanup(os.chdir, cls.before)
        Path("machine.toml").write_text(MACHINE)
        Path("model.toml").write_text(MODEL)
        for number, law in enumerate(INPUTS, 1):
            name = f"{number}.csv"
            ds.simulate("machine.toml", input=law, duration=4.0, seed=number, output=name)

    def told(self, *arguments: str, code: int = 0) -> str:
        """Return what the program writes with `--json -`."""
        command = [PROGRAM, *arguments, "--json", "-", "--quiet"]
        ran = subprocess.run(command, capture_output=True, text=True, timeout=300)
        self.assertEqual(ran.returncode, code, ran.stderr)
        return ran.stdout if code == 0 else ran.stderr
