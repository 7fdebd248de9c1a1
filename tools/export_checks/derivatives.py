"""Directional and adjoint derivatives against central differences."""

from ctypes import c_double

import numpy as np

from .fmu import REAL, check

# Central differences at this relative step leave an error of about its square.
DIFFERENCE = 1e-6
DERIVATIVE_TOLERANCE = 1e-6


def check_derivatives(fmu):
    """Directional and adjoint derivatives in Model Exchange, and the claimed dependencies."""
    exchange = fmu.description.modelExchange
    provided = exchange and exchange.providesDirectionalDerivative
    if not fmu.two and exchange:
        text = (fmu.folder / "modelDescription.xml").read_text()
        provided = 'providesDirectionalDerivatives="true"' in text
    if not provided:
        return
    structure = fmu.description.derivatives + fmu.description.outputs
    rows = [u for u in structure if u.variable.type in REAL]
    unknowns = [u.variable.valueReference for u in rows]
    states = [u.variable.derivative.valueReference for u in fmu.description.derivatives]
    inputs = fmu.references(
        lambda v: v.causality == "input" and v.variability == "continuous" and v.type in REAL
    )
    worst = adjoint_error = 0.0
    undeclared = set()
    with fmu.instance("ModelExchange") as instance:
        fmu.initialize(instance, "ModelExchange")
        instance.enterContinuousTimeMode()
        nx = len(states)
        x0, nominals = (c_double * nx)(), (c_double * nx)()
        instance.getContinuousStates(x0, nx)
        instance.getNominalsOfContinuousStates(nominals, nx)
        # Away from the start values, where much is zero; every direction of motion.
        for sign in (1.0, -1.0):
            base = [x + sign * 0.3 * n for x, n in zip(x0, nominals)]
            u0 = list(fmu.get(instance, inputs)) if inputs else []

            def values(known, change):
                x, u = list(base), list(u0)
                if known < nx:
                    x[known] += change
                else:
                    u[known - nx] += change
                instance.setContinuousStates((c_double * nx)(*x), nx)
                if inputs:
                    fmu.set(instance, inputs, u)
                return fmu.get(instance, unknowns)

            columns = []
            for known, reference in enumerate(states + inputs):
                size = max(nominals[known] if known < nx else 1.0, 1e-9) * DIFFERENCE
                expected = (values(known, size) - values(known, -size)) / (2 * size)
                values(known, 0.0)
                found = np.array(instance.getDirectionalDerivative(unknowns, [reference], [1.0]))
                columns.append(found)
                scale = np.maximum(1.0, np.abs(expected))
                worst = max(worst, np.max(np.abs(found - expected) / scale))
                for row, value in zip(rows, expected):
                    names = {v.valueReference for v in row.dependencies or []}
                    if abs(value) > 1e-9 and reference not in names:
                        undeclared.add((row.variable.name, reference))
            jacobian = np.array(columns).T
            seed = np.cos(np.arange(len(states + inputs)) + 1.0)
            both = np.array(
                instance.getDirectionalDerivative(unknowns, states + inputs, list(seed))
            )
            worst = max(worst, np.max(np.abs(both - jacobian @ seed) / np.maximum(1, abs(both))))
            if not fmu.two:
                weights = np.sin(np.arange(len(unknowns)) + 1.0)
                found = instance.getAdjointDerivative(
                    unknowns, states + inputs, list(weights), len(states + inputs)
                )
                adjoint_error = np.max(np.abs(np.array(found) - weights @ jacobian))
    check(
        "directional derivatives equal differences",
        worst <= DERIVATIVE_TOLERANCE,
        f"{worst:.1e}",
    )
    if not fmu.two:
        check(
            "adjoint derivatives equal J' w",
            adjoint_error <= 1e-9,
            f"{adjoint_error:.1e}",
        )
    check("dependencies are claimed", not undeclared, undeclared or "")
