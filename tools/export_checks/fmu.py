"""An unpacked FMU, and how a result is printed."""

from contextlib import contextmanager
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.simulation import instantiate_fmu

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
TIMEOUT = 60.0  # s; fmpy runs on for ever without one
REAL = ("Real", "Float64")


class Results:
    """What was checked."""

    failures = 0

    @classmethod
    def check(cls, name, passed, detail=""):
        """Prints one result."""
        cls.failures += not passed
        print(
            f"  {'ok  ' if passed else 'FAIL'} {name}{': ' + str(detail) if detail != '' else ''}"
        )


check = Results.check


class Fmu:
    """An unpacked FMU with what both versions call differently."""

    def __init__(self, path):
        self.path = Path(path)
        self.folder = Path(extract(str(path)))
        self.description = read_model_description(str(path), validate=False)
        self.two = self.description.fmiVersion == "2.0"
        self.prefix = "fmi2" if self.two else "fmi3"
        self.kinds = [
            kind
            for kind, offered in (
                ("CoSimulation", self.description.coSimulation),
                ("ModelExchange", self.description.modelExchange),
            )
            if offered is not None
        ]
        self.variables = self.description.modelVariables
        experiment = self.description.defaultExperiment
        self.start, self.stop = float(experiment.startTime), float(experiment.stopTime)
        self.step = float(experiment.stepSize)

    def references(self, keep):
        return [v.valueReference for v in self.variables if keep(v)]

    @contextmanager
    def instance(self, kind, logging=True, folder=None):
        """An instance; its log messages are in `.messages` as (status, category, text)."""
        messages = []

        def log(*arguments):
            status, category, text = arguments[-3:]
            messages.append((status, category.decode(), text.decode()))

        fmu = instantiate_fmu(
            str(folder or self.folder),
            self.description,
            kind,
            debug_logging=logging,
            logger=log,
        )
        fmu.messages = messages
        try:
            yield fmu
        finally:
            fmu.freeInstance()

    def initialize(self, fmu, kind):
        if self.two:
            fmu.setupExperiment(startTime=self.start)
            fmu.enterInitializationMode()
        else:
            fmu.enterInitializationMode(startTime=self.start)
        fmu.exitInitializationMode()
        if kind == "ModelExchange":
            self.iterate(fmu)

    def iterate(self, fmu):
        """Event iteration; the next event time or None."""
        again = True
        while again:
            again, _, _, _, defined, time = (
                fmu.newDiscreteStates() if self.two else fmu.updateDiscreteStates()
            )
        return time if defined else None

    def get(self, fmu, references):
        return np.array((fmu.getReal if self.two else fmu.getFloat64)(references))

    def set(self, fmu, references, values):
        (fmu.setReal if self.two else fmu.setFloat64)(references, values)

    def call(self, fmu, name, *arguments):
        """A C function by its name without prefix, with raw arguments; its status."""
        return fmu._functions[self.prefix + name](*arguments)
