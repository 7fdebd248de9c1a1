"""Runs over the default experiment: one interface against the other."""

import math

import numpy as np
from fmpy import simulate_fmu

from .fmu import REAL, TIMEOUT, check


def check_runs(fmu, tolerance):
    """Both interfaces over the default experiment."""
    results = {}
    for kind in fmu.kinds:
        try:
            results[kind] = simulate_fmu(
                str(fmu.path),
                fmi_type=kind,
                stop_time=fmu.stop,
                output_interval=fmu.step,
                relative_tolerance=1e-10,
                record_events=False,
                timeout=TIMEOUT,
            )
            ended = results[kind]["time"][-1]
            check(f"{kind} runs to the stop time", math.isclose(ended, fmu.stop), ended)
        except Exception as error:
            check(f"{kind} runs to the stop time", False, error)
    if len(results) == 2:
        cs, me = results.values()
        worst = 0.0
        for v in fmu.variables:
            if v.causality == "output" and v.type in REAL and v.variability == "continuous":
                scale = max(np.max(np.abs(cs[v.name])), 1e-300)
                worst = max(worst, np.max(np.abs(cs[v.name] - me[v.name])) / scale)
        check("Co-Simulation equals Model Exchange", worst <= tolerance, f"{worst:.2e}")


def check_discrete_inputs(fmu, tolerance):
    """Discrete inputs that jump at every fifth communication point: Co-Simulation against Model
    Exchange, once on the importer's grid and once on one that rounding has moved."""
    discrete = [
        v
        for v in fmu.variables
        if v.causality == "input" and v.variability == "discrete" and v.type in REAL
    ]
    if not discrete or len(fmu.kinds) < 2:
        return
    inputs = [v for v in fmu.variables if v.causality == "input"]
    points = round((fmu.stop - fmu.start) / fmu.step) // 5 + 1
    for name, factor in (("", 1.0), (" on a rounded grid", 1.0 + 2.0**-52)):
        time = (fmu.start + np.arange(points) * 5 * fmu.step) * factor
        # Outputs just before the next jump: at a jump an importer may record either side.
        columns = [(v.name, float(v.start) + np.zeros(points)) for v in inputs]
        for index, v in enumerate(discrete):
            jumps = 0.3 * float(v.nominal or 1.0) * np.cos(np.arange(points) + index)
            columns[inputs.index(v)] = (v.name, float(v.start) + jumps)
        signals = np.array(
            list(zip(time, *(values for _, values in columns))),
            dtype=[("time", float)] + [(name, float) for name, _ in columns],
        )
        runs = []
        for kind in fmu.kinds:
            run = simulate_fmu(
                str(fmu.path),
                fmi_type=kind,
                stop_time=fmu.stop,
                output_interval=fmu.step,
                relative_tolerance=1e-10,
                input=signals,
                record_events=False,
                timeout=TIMEOUT,
            )
            runs.append(run)
        worst = 0.0
        for v in fmu.variables:
            if v.causality == "output" and v.type in REAL and v.variability == "continuous":
                cs, me = (run[v.name][4::5] for run in runs)
                worst = max(worst, np.max(np.abs(cs - me)) / max(np.max(np.abs(cs)), 1e-300))
        check(
            f"discrete inputs{name}: the interfaces agree",
            worst <= tolerance,
            f"{worst:.2e}",
        )
