"""Times of other people's programs on a drive: `speed.py FMU INPUTS SAMPLES`, answers JSON.

INPUTS is a CSV file of voltage [V] and load torque [N m], a row a sample; the numbers of the motor
are those of the environment variable DRIVE, as JSON. Each time is the least of some repetitions, in
seconds a sample.
"""

import csv
import json
import math
import os
import sys
import time
from pathlib import Path

REPEATED = 3


def least(work, samples):
    """Return the least seconds a sample."""
    best = math.inf
    for _ in range(REPEATED):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best / samples


def scipy_loop(inputs, motor):
    """Return the seconds of `solve_ivp` at 1e-6, anew over every sample."""
    import scipy
    from scipy.integrate import solve_ivp

    period = motor["period"]

    def run():
        y = [motor["i"], motor["omega"]]
        for u, load in inputs:

            def rhs(_, y, u=u, load=load):
                i, omega = y
                dry = motor["T_c"] + motor["T_b"] * math.exp(-((omega / motor["omega_s"]) ** 2))
                torque = motor["K_m"] * i - motor["B_m"] * omega - math.copysign(dry, omega) - load
                return [
                    (u - motor["R"] * i - motor["K_e"] * omega) / motor["L"],
                    torque / motor["J"],
                ]

            y = solve_ivp(rhs, (0.0, period), y, rtol=1e-6, atol=1e-6).y[:, -1]

    return least(run, len(inputs)), scipy.__version__


def fmpy_loops(fmu, samples, period):
    """Return the seconds of a loop over `doStep`, and of `simulate_fmu`."""
    import fmpy
    from fmpy import extract, read_model_description, simulate_fmu
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(fmu)
    folder = extract(fmu)
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="peer",
    )
    slave.instantiate()
    references = {it.name: it.valueReference for it in description.modelVariables}

    def loop():
        slave.reset()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.setReal([references["reference"]], [209.44])
        slave.exitInitializationMode()
        for k in range(samples):
            slave.doStep(currentCommunicationPoint=k * period, communicationStepSize=period)
            slave.getReal([references["T"]])

    by_hand = least(loop, samples)
    slave.terminate()
    slave.freeInstance()

    def simulate():
        simulate_fmu(
            folder,
            model_description=description,
            stop_time=samples * period,
            step_size=period,
            output_interval=period,
            start_values={"reference": 209.44},
            output=["T"],
        )

    return by_hand, least(simulate, samples), fmpy.__version__


def main():
    """Print what each takes, or why it was not run."""
    fmu, file, samples = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3])
    with file.open(newline="") as rows:
        inputs = [tuple(map(float, row)) for row in csv.reader(rows)]
    motor = json.loads(os.environ["DRIVE"])
    found = {}
    try:
        found["scipy_s"], found["scipy"] = scipy_loop(inputs[: max(100, samples // 20)], motor)
    except ImportError as error:
        found["scipy_why"] = str(error)
    try:
        times = fmpy_loops(fmu, samples, motor["period"])
        found["fmpy_loop_s"], found["fmpy_simulate_s"], found["fmpy"] = times
    except ImportError as error:
        found["fmpy_why"] = str(error)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
