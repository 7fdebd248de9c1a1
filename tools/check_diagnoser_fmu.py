#!/usr/bin/env python3
"""Checks the FMU of a diagnoser with fmpy: alone, and in a loop with the FMU of its drive.

    check_diagnoser_fmu.py PROGRAM [--folder DIR]

PROGRAM simulates two healthy runs of the laboratory rig and trains a diagnoser on them. Its FMU, of
FMI 2.0 and 3.0, is validated by fmpy and stepped together with the drive's FMU; what it decides
must be what `diagnose` decides on the signals that were recorded on the way, to the bit. FMU states
are serialised in the middle of the run and gone on from in a new instance.

Prints one line a check. Exit code 1 if one fails.
"""

import argparse
import json
import math
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

PERIOD = 0.005
SAMPLES = 2400
ONSET = 1600
SIGNALS = ["C_m", "T", "I_m"]
DECIDED = ["alarms", "mechanism", "size", "size_lower", "size_upper"]
failures = 0


def check(what, right, said=""):
    """Prints a line."""
    global failures
    failures += not right
    print(f"{'ok' if right else 'FAILED'}  {what} {'' if right else said}")


class Slave:
    """An FMU for Co-Simulation, of either version."""

    def __init__(self, path):
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))
        two = self.description.fmiVersion == "2.0"
        make = FMU2Slave if two else FMU3Slave
        self.two = two
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        self.type = {v.name: v.type for v in self.description.modelVariables}
        self.fmu = make(
            guid=self.description.guid if two else self.description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.fmu.instantiate()
        if two:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()

    def get(self, names):
        """Values of outputs."""
        values = []
        for name in names:
            one = [self.reference[name]]
            kind = self.type[name]
            if kind in ("Real", "Float64"):
                get = self.fmu.getReal if self.two else self.fmu.getFloat64
            elif kind in ("Integer", "Int32"):
                get = self.fmu.getInteger if self.two else self.fmu.getInt32
            else:
                get = self.fmu.getBoolean
            values.append(float(get(one)[0]))
        return values

    def set(self, values):
        """Sets real inputs."""
        put = self.fmu.setReal if self.two else self.fmu.setFloat64
        put([self.reference[name] for name in values], list(values.values()))

    def step(self, time):
        """One communication step."""
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=PERIOD)

    def saved(self):
        """The state as bytes."""
        if self.two:
            state = self.fmu.getFMUstate()
            saved = self.fmu.serializeFMUstate(state)
            self.fmu.freeFMUstate(state)
        else:
            state = self.fmu.getFMUState()
            saved = self.fmu.serializeFMUState(state)
            self.fmu.freeFMUState(state)
        return saved

    def restore(self, saved):
        """Goes on from that state."""
        if self.two:
            state = self.fmu.deSerializeFMUstate(saved)
        else:
            state = self.fmu.deserializeFMUState(saved)
        (self.fmu.setFMUstate if self.two else self.fmu.setFMUState)(state)

    def close(self):
        """Frees what there is."""
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def run(program, folder, *arguments):
    """What the program prints."""
    done = subprocess.run(
        [program, *arguments], cwd=folder, check=True, capture_output=True, text=True, timeout=600
    )
    return done.stdout


def loop(folder, fmi):
    """Plant and diagnoser step together: recorded rows, and decisions row by row."""
    plant, watch = Slave(folder / "plant.fmu"), Slave(folder / f"rig{fmi}.fmu")
    noise = random.Random(7)
    left, load = math.exp(-PERIOD / 0.05), 0.0
    rows, decided, other = [], [], None
    for k in range(SAMPLES):
        time = k * PERIOD
        load = left * load + math.sqrt(1 - left * left) * noise.gauss(0.0, 1e-3)
        plant.set(
            {
                "reference": 209.44,
                "noise_T": noise.gauss(0.0, 3.0),
                "noise_I_m": noise.gauss(0.0, 0.01),
                "noise_T_l": load,
                "fault_actuator": 0.1 if k >= ONSET else 0.0,
            }
        )
        row = plant.get(SIGNALS)
        rows.append(row)
        for one in [watch] + ([other] if other else []):
            one.set(dict(zip(SIGNALS, row, strict=True)))
            one.step(time)
        decided.append(watch.get(DECIDED))
        if other and other.get(DECIDED) != decided[-1]:
            check(f"FMI {fmi}: restored bytes decide alike at row {k}", False)
            break
        if k == ONSET + 20:
            try:
                other = Slave(folder / f"rig{fmi}.fmu")
                other.restore(watch.saved())
            except Exception as error:  # fmpy wraps what it lacks in many kinds of errors
                check(f"FMI {fmi}: state serialised and restored", False, repr(error))
                other = None
        plant.step(time)
    check(f"FMI {fmi}: a restored instance decides alike to the end", other is not None)
    for one in [plant, watch] + ([other] if other else []):
        one.close()
    return rows, decided


def main():
    """Runs all checks."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    program = str(Path(arguments.program).resolve())
    folder = arguments.folder or Path(tempfile.mkdtemp())
    for seed in ("1", "2"):
        usual = ["simulate", "dr300", "--reference", "2000 [rpm]", "--duration", "20", "--quiet"]
        run(program, folder, *usual, "--seed", seed, "-o", f"h{seed}.csv")
    quick = ["--without", "recurrent,gmdh", "--verify", "100000", "--quiet"]
    run(program, folder, "train", "h1.csv", "h2.csv", "--drive", "dr300", *quick, "-o", "rig.toml")
    run(program, folder, "export", "dr300", "-o", "plant.fmu", "--fmi", "2")
    for fmi in (2, 3):
        run(program, folder, "export", "rig.toml", "-o", f"rig{fmi}.fmu", "--fmi", str(fmi))
        problems = validate_fmu(str(folder / f"rig{fmi}.fmu"))
        check(f"FMI {fmi}: fmpy validates without a message", not problems, problems)
        rows, decided = loop(folder, fmi)
        text = "time [s],C_m [V],T [rpm],I_m [A]\n"
        text += "".join(f"{k * PERIOD!r},{c!r},{t!r},{i!r}\n" for k, (c, t, i) in enumerate(rows))
        (folder / "recorded.csv").write_text(text)
        with (folder / "recorded.csv").open() as file:
            said = subprocess.run(
                [program, "diagnose", "rig.toml", "-", "--json", "-", "--quiet"],
                cwd=folder,
                stdin=file,
                check=True,
                capture_output=True,
                text=True,
                timeout=600,
            ).stdout
        lines = [json.loads(line) for line in said.splitlines()]
        expected = [
            (round(line["time"] / PERIOD), line["size"], *line["interval"])
            for line in lines
            if line.get("decision") == "judged" and line["size"] is not None
        ]
        found = [
            (k, *decided[k][2:])
            for k in range(1, len(decided))
            if decided[k][0] > decided[k - 1][0]
        ]
        check(
            f"FMI {fmi}: declared at the rows of diagnose, bit for bit",
            found == expected,
            f"{found} {expected}",
        )
        check(f"FMI {fmi}: the actuator is found", len(expected) == 1, expected)
    if not arguments.folder:
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
