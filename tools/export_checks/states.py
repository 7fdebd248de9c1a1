"""FMU states: saved, restored, serialised, replayed."""

import numpy as np

from .fmu import REAL, check


def check_states(fmu):
    """FMU states: roll back and replay, in the same and in another instance."""
    reals = fmu.references(lambda v: v.type in REAL)
    if "CoSimulation" not in fmu.kinds:
        return

    def run(instance, first, steps):
        rows = []
        for k in range(first, first + steps):
            instance.doStep(fmu.start + k * fmu.step, fmu.step)
            rows.append(fmu.get(instance, reals))
        return np.array(rows).tobytes()

    steps = max(2, min(100, round((fmu.stop - fmu.start) / fmu.step) // 2))
    with fmu.instance("CoSimulation") as one, fmu.instance("CoSimulation") as two:
        fmu.initialize(one, "CoSimulation")
        run(one, 0, steps)
        state = one.getFMUState()
        data = one.serializeFMUState(state)
        first = run(one, steps, steps)
        one.setFMUState(state)
        check("roll back and replay, bit-equal", run(one, steps, steps) == first)
        copy = two.deserializeFMUState(data)
        check("serialised again, the same bytes", two.serializeFMUState(copy) == data)
        two.setFMUState(copy)
        check(
            "replay of serialised bytes in a new instance, bit-equal",
            run(two, steps, steps) == first,
        )
        one.reset()
        fmu.initialize(one, "CoSimulation")
        run(one, 0, steps)
        check("replay after reset, bit-equal", run(one, steps, steps) == first)
        one.freeFMUState(state)
        check("a freed state is NULL", not state.value)
    if "ModelExchange" in fmu.kinds:
        with fmu.instance("ModelExchange") as instance:
            fmu.initialize(instance, "ModelExchange")
            before = fmu.get(instance, reals).tobytes()
            state = instance.getFMUState()
            instance.enterContinuousTimeMode()
            instance.setTime(fmu.start + fmu.step)
            inputs = fmu.references(
                lambda v: v.causality == "input" and v.variability == "continuous"
            )
            fmu.set(instance, inputs, [0.5] * len(inputs))
            changed = fmu.get(instance, reals).tobytes() != before
            instance.setFMUState(state)
            restored = fmu.get(instance, reals).tobytes() == before
            check("Model Exchange: time, mode and inputs restored", changed and restored)
            fmu.iterate(instance)
            instance.freeFMUState(state)
