#!/usr/bin/env python3
"""Checks exported FMUs with fmpy, the independent importer.

    check_export.py [--tolerance 1e-6] [--skip-stress] FMU...

For each FMU, of FMI 2.0 or 3.0, through every interface that it offers: validation without a
message; runs over the default experiment, Co-Simulation against Model Exchange; FMU states rolled
back, serialised and replayed bit for bit; directional and adjoint derivatives against central
differences, and the dependencies that the model structure claims; wrong calls, each answered with
an error status and a log message; instances without a resources folder; a storm of random calls.

Prints one line a check. Exit code 1 if one fails.
"""

import argparse
import shutil
import sys

from export_checks.derivatives import check_derivatives
from export_checks.edges import (
    check_null_instance,
    check_storm,
    check_without_resources,
    storm,
)
from export_checks.fmu import Fmu, Results, check
from export_checks.runs import check_discrete_inputs, check_runs
from export_checks.states import check_states
from export_checks.wrong_calls import check_wrong_calls
from fmpy.validation import validate_fmu


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmus", nargs="+", metavar="FMU")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="CS against ME, relative")
    parser.add_argument("--skip-stress", action="store_true", help="no random calls")
    parser.add_argument("--storm", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    for path in arguments.fmus:
        fmu = Fmu(path)
        try:
            if arguments.storm:
                storm(fmu)
                continue
            print(f"{path} (FMI {fmu.description.fmiVersion})")
            problems = validate_fmu(str(path))
            check("fmpy validates without a message", not problems, problems or "")
            check_runs(fmu, arguments.tolerance)
            check_discrete_inputs(fmu, arguments.tolerance)
            check_states(fmu)
            check_derivatives(fmu)
            check_wrong_calls(fmu)
            check_null_instance(fmu)
            check_without_resources(fmu)
            if not arguments.skip_stress:
                check_storm(fmu)
        finally:
            shutil.rmtree(fmu.folder, ignore_errors=True)
    if not arguments.storm:
        print(f"{Results.failures} failed" if Results.failures else "all passed")
    return 1 if Results.failures else 0


if __name__ == "__main__":
    sys.exit(main())
