"""drivescope: what is wrong with an electric drive, or with its model, from its signals.

The functions are the commands of the program, with its options as keywords; an option that is left
out has the default of the command line, and `drivescope COMMAND --help` describes each. An answer
is a mapping: what `--json` writes, byte for byte in its `json`.

    import drivescope as ds

    run = ds.simulate("dr300", duration=8.0, seed=3)
    found = ds.discover("model.toml", ["one.csv", "two.csv"])
    found["named"], found.drive

A drive is the name of a built-in one, a path, or a `Drive`; a recording is a path, a `Recording`,
a data frame, an Arrow table or a mapping of arrays, with headers such as `omega [rad/s]`.

Input that cannot be used raises `drivescope.Error` (a `ValueError`) with the words of the command
line, an error of the program itself `RuntimeError`. Ctrl-C ends every function; files appear whole
or not at all.
"""

import atexit

from . import _drivescope
from ._commands import (
    add,
    campaign,
    compare,
    diagnose,
    discover,
    export_fmu,
    fit,
    simulate,
    study,
    train,
)
from ._drive import Diagnoser, Drive
from ._drivescope import Error, __version__
from ._recording import Recording
from ._results import (
    Answer,
    Campaign,
    Comparison,
    Diagnosis,
    Discovery,
    Export,
    Fit,
    Simulation,
    Study,
    Training,
)

# Temporary files of calls that were left to themselves.
atexit.register(_drivescope.leave_nothing)

__all__ = [
    "Answer",
    "Campaign",
    "Comparison",
    "Diagnoser",
    "Diagnosis",
    "Discovery",
    "Drive",
    "Error",
    "Export",
    "Fit",
    "Recording",
    "Simulation",
    "Study",
    "Training",
    "__version__",
    "add",
    "campaign",
    "compare",
    "diagnose",
    "discover",
    "export_fmu",
    "fit",
    "simulate",
    "study",
    "train",
]
