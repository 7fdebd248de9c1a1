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
import math
import os
import random
import shutil
import subprocess
import sys
from contextlib import contextmanager
from ctypes import POINTER, byref, c_bool, c_char_p, c_double, c_int, c_size_t, c_void_p, cast
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.simulation import instantiate_fmu
from fmpy.validation import validate_fmu

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
TIMEOUT = 60.0  # s; fmpy runs on for ever without one
REAL = ("Real", "Float64")
# Central differences at this relative step leave an error of about its square.
DIFFERENCE = 1e-6
DERIVATIVE_TOLERANCE = 1e-6

failures = 0


def check(name, passed, detail=""):
    """Prints one result."""
    global failures
    failures += not passed
    print(f"  {'ok  ' if passed else 'FAIL'} {name}{': ' + str(detail) if detail != '' else ''}")


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
            str(folder or self.folder), self.description, kind, debug_logging=logging, logger=log
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
        check(f"discrete inputs{name}: the interfaces agree", worst <= tolerance, f"{worst:.2e}")


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
        check("replay of serialised bytes in a new instance, bit-equal", run(two, steps, steps) == first)
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
            both = np.array(instance.getDirectionalDerivative(unknowns, states + inputs, list(seed)))
            worst = max(worst, np.max(np.abs(both - jacobian @ seed) / np.maximum(1, abs(both))))
            if not fmu.two:
                weights = np.sin(np.arange(len(unknowns)) + 1.0)
                found = instance.getAdjointDerivative(
                    unknowns, states + inputs, list(weights), len(states + inputs)
                )
                adjoint_error = np.max(np.abs(np.array(found) - weights @ jacobian))
    check("directional derivatives equal differences", worst <= DERIVATIVE_TOLERANCE, f"{worst:.1e}")
    if not fmu.two:
        check("adjoint derivatives equal J' w", adjoint_error <= 1e-9, f"{adjoint_error:.1e}")
    check("dependencies are claimed", not undeclared, undeclared or "")


def wrong_calls(fmu, instance):
    """(what, call, expected status) in a Co-Simulation instance; order matters."""
    c = instance.component
    call = lambda name, *arguments: fmu.call(instance, name, c, *arguments)
    real = "Real" if fmu.two else "Float64"
    output = fmu.references(lambda v: v.causality == "output" and v.initial == "calculated" and v.type in REAL)
    inputs = fmu.references(lambda v: v.causality == "input" and v.type in REAL)
    fixed = fmu.references(lambda v: v.causality == "parameter" and v.variability == "fixed" and v.type in REAL)
    parameter = fmu.references(lambda v: v.causality == "parameter" and v.type in REAL)
    constant = fmu.references(lambda v: v.variability == "constant" and v.type in REAL)
    uint32 = instance._functions[fmu.prefix + "Get" + real].argtypes[1]._type_

    def access(verb, references, values, kind=real):
        n = len(references)
        array = (uint32 * n)(*references)
        function = instance._functions[f"{fmu.prefix}{verb}{kind}"]
        buffer = (function.argtypes[3]._type_ * n)(*values)
        return call(verb + kind, array, n, buffer, *([] if fmu.two else [n]))

    flags = () if fmu.two else (byref(c_bool()), byref(c_bool()), byref(c_bool()), byref(c_double()))
    step = lambda t, h: call("DoStep", t, h, 1, *flags)
    state = c_void_p(987654321)
    spelled = ("FMUstate", "SerializedFMUstateSize", "DeSerializeFMUstate") if fmu.two else ("FMUState", "SerializedFMUStateSize", "DeserializeFMUState")
    byte = instance._functions[fmu.prefix + spelled[2]].argtypes[1]._type_
    start, h = fmu.start, fmu.step

    yield "step before initialization", lambda: step(start, h), ERROR
    if fmu.two:
        yield "initialization without experiment", lambda: call("EnterInitializationMode"), ERROR
        yield "get before initialization", lambda: access("Get", output[:1], [0]), ERROR
        yield "experiment that starts at NaN", lambda: call("SetupExperiment", 0, 0.0, math.nan, 0, 0.0), ERROR
    yield "terminate before initialization", lambda: call("Terminate"), ERROR
    yield "exit of a mode not entered", lambda: call("ExitInitializationMode"), ERROR
    if parameter:
        yield "parameter that is NaN", lambda: access("Set", parameter[:1], [math.nan]), ERROR
    yield "initialization", lambda: fmu.initialize(instance, "CoSimulation") or OK, OK
    yield "second experiment", lambda: call("SetupExperiment", 0, 0.0, 0.0, 0, 0.0) if fmu.two else call("EnterInitializationMode", False, 0.0, 0.0, False, 0.0), ERROR
    yield "unknown value reference", lambda: access("Get", [4_000_000_000], [0]), ERROR
    yield "value of the wrong type", lambda: access("Get", output[:1], [0], "Boolean"), ERROR
    yield "NULL references", lambda: call("Get" + real, None, 1, (c_double * 1)(), *([] if fmu.two else [1])), ERROR
    yield "NULL values", lambda: call("Get" + real, (uint32 * 1)(*output[:1]), 1, None, *([] if fmu.two else [1])), ERROR
    yield "no values at all", lambda: call("Get" + real, None, 0, None, *([] if fmu.two else [0])), OK
    if not fmu.two:
        yield "array of the wrong length", lambda: call("GetFloat64", (uint32 * 1)(*output[:1]), 1, (c_double * 2)(), 2), ERROR
        yield "clock", lambda: call("GetClock", (uint32 * 1)(*output[:1]), 1, (c_bool * 1)()), ERROR
        yield "event mode", lambda: call("EnterEventMode"), ERROR
        yield "configuration mode", lambda: call("EnterConfigurationMode"), ERROR
    if output:
        yield "output set", lambda: access("Set", output[:1], [1.0]), ERROR
    if constant:
        yield "constant set", lambda: access("Set", constant[:1], [1.0]), ERROR
    if fixed:
        yield "fixed parameter set after initialization", lambda: access("Set", fixed[:1], [1.0]), ERROR
    if inputs:
        for value in (math.nan, math.inf):
            yield f"input {value}", lambda value=value: access("Set", inputs[:1], [value]), ERROR
        yield "input", lambda: access("Set", inputs[:1], [0.0]), OK
    for what, t, size in (
        ("step of size 0", start, 0.0),
        ("step backwards", start, -h),
        ("step of size NaN", start, math.nan),
        ("endless step", start, math.inf),
        ("step at another time", start + 5 * h, h),
        ("step at NaN", math.nan, h),
    ):
        yield what, lambda t=t, size=size: step(t, size), ERROR
    yield "set of a foreign state", lambda: call("Set" + spelled[0], state), ERROR
    yield "free of a foreign state", lambda: call("Free" + spelled[0], byref(state)), ERROR
    yield "size of a foreign state", lambda: call(spelled[1], state, byref(c_size_t())), ERROR
    yield "bytes that are no state", lambda: call(spelled[2], (byte * 9)(), 9, byref(c_void_p())), ERROR
    yield "unknown log category", lambda: call("SetDebugLogging", 1, 1, (c_char_p * 1)(b"nonsense")), ERROR
    yield "Model Exchange function", lambda: instance.dll[fmu.prefix + "EnterContinuousTimeMode"](c_void_p(c)), ERROR
    if fmu.two:
        yield "status of no pending step", lambda: call("GetStatus", 0, byref(c_int())), DISCARD
        yield "input derivatives", lambda: call("SetRealInputDerivatives", None, 0, None, None), ERROR
        yield "cancel of no step", lambda: call("CancelStep"), ERROR
    yield "right step after all this", lambda: step(start, h), OK
    yield "terminate", lambda: call("Terminate"), OK
    yield "step after terminate", lambda: step(start + h, h), ERROR
    yield "get after terminate", lambda: access("Get", output[:1], [0]), OK
    yield "reset", lambda: call("Reset"), OK
    yield "run after reset", lambda: fmu.initialize(instance, "CoSimulation") or step(start, h), OK
    boom = fmu.references(lambda v: v.name == "panics")
    if boom:
        yield "panic armed", lambda: access("Set", boom, [1], "Boolean"), OK
        yield "panic", lambda: step(start + h, h), FATAL
        yield "call after panic", lambda: call("Reset"), FATAL


def check_wrong_calls(fmu):
    """Each wrong call has its status and a message, and with logging off none."""
    if "CoSimulation" not in fmu.kinds:
        return
    for logging in (True, False):
        wrong, silent, n = [], [], 0
        with fmu.instance("CoSimulation", logging) as instance:
            for what, call, expected in wrong_calls(fmu, instance):
                instance.messages.clear()
                status = call()
                n += 1
                if what == "unknown log category" and not logging:
                    continue
                if status != expected:
                    wrong.append((what, status, instance.messages))
                told = [m for m in instance.messages if m[0] == expected]
                if expected != OK and bool(told) != logging:
                    silent.append((what, instance.messages))
        name = "wrong calls" if logging else "the same, logging off"
        check(f"{name}: statuses of {n} calls", not wrong, wrong or "")
        check(f"{name}: messages", not silent, silent or "")
    token = fmu.description.guid
    fmu.description.guid = "{00000000-0000-0000-0000-000000000000}"
    try:
        with fmu.instance("CoSimulation"):
            check("a wrong token is refused", False)
    except Exception as error:
        check("a wrong token is refused", "nstantiate" in str(error), error)
    finally:
        fmu.description.guid = token


def check_null_instance(fmu):
    """Every function that takes an instance answers NULL with an error."""
    wrong, n = [], 0
    for kind in fmu.kinds:
        with fmu.instance(kind) as instance:
            for name, function in instance._functions.items():
                if function.restype is not c_int or "Instantiate" in name:
                    continue
                n += 1
                arguments = [argument(random.Random(0), t, None) for t in function.argtypes[1:]]
                if function(None, *arguments) != ERROR:
                    wrong.append(name)
            getattr(instance.dll, fmu.prefix + "FreeInstance")(None)
    check(f"{n} functions answer a NULL instance", not wrong, wrong or "")


def check_without_resources(fmu):
    """Instances whose resources folder does not exist, or whose path is NULL."""
    bare = fmu.folder.with_name(fmu.folder.name + "_bare")
    shutil.copytree(fmu.folder, bare)
    shutil.rmtree(bare / "resources", ignore_errors=True)
    outcomes = []
    for kind in fmu.kinds:
        try:
            with fmu.instance(kind, folder=bare) as instance:
                fmu.initialize(instance, kind)
                outcomes.append("runs")
        except FMICallException as error:
            outcomes.append(f"broken: {error}")
        except Exception:
            outcomes.append("refused")
    fine = set(outcomes) <= {"runs", "refused"}
    check("without a resources folder", fine, ", ".join(outcomes))
    with fmu.instance(fmu.kinds[0]) as instance:
        name, token = b"null", fmu.description.guid.encode()
        functions = instance._functions
        if fmu.two:
            made = functions["fmi2Instantiate"](name, int(fmu.kinds[0] == "CoSimulation"), token, None, byref(instance.callbacks), 0, 0)
            none = functions["fmi2Instantiate"](name, 1, token, None, None, 0, 0)
            check("without callbacks", not none)
        else:
            log = instance.logMessage
            if fmu.kinds[0] == "CoSimulation":
                make = functions["fmi3InstantiateCoSimulation"]
                made = make(name, token, None, False, False, False, False, None, 0, None, log, instance.intermediateUpdate)
                event = make(name, token, None, False, False, True, False, None, 0, None, log, instance.intermediateUpdate)
                check("event mode, which is not offered, is refused", not event)
            else:
                made = functions["fmi3InstantiateModelExchange"](name, token, None, False, False, None, log)
        if made:
            functions[fmu.prefix + "FreeInstance"](made)
        check("a NULL resource path", True, "runs" if made else "refused")
    shutil.rmtree(bare)


def argument(rng, kind, references):
    """A random argument of a ctypes type: a valid buffer of 64 places, NULL, or a number."""
    if kind is c_double:
        return rng.choice([0.0, 0.01, 0.02, 0.1, -1.0, 1.0, math.nan, math.inf])
    if kind is c_void_p:
        return c_void_p(rng.choice([0, 1, 2, 3, 99]))
    if kind is c_char_p:
        return rng.choice([None, b"logAll", b"nonsense"])
    if kind is c_bool:
        return rng.choice([False, True])
    if hasattr(kind, "_type_") and not isinstance(kind._type_, str):
        if rng.random() < 0.1:
            return None
        inner = kind._type_
        if inner is c_char_p:
            values = [rng.choice([b"logAll", b"logEvents", b"nonsense"]) for _ in range(64)]
        elif inner is c_double:
            values = [rng.choice([0.0, 1.0, 0.3, -2.0, math.nan]) for _ in range(64)]
        elif inner is c_void_p or hasattr(inner, "_fields_") or hasattr(inner, "contents"):
            return cast((inner * 64)(), POINTER(inner))
        else:
            values = [rng.choice(references or [0]) & 0x7F for _ in range(64)]
        return cast((inner * 64)(*values), POINTER(inner))
    return rng.choice([0, 1, 1, 2, 64])


def storm(fmu, calls=20_000):
    """Random calls in random order with valid or NULL pointers. Nothing may abort."""
    rng = random.Random(1)
    references = [v.valueReference for v in fmu.variables] + [77]
    for kind in fmu.kinds:
        for _ in range(20):
            with fmu.instance(kind) as instance:
                if rng.random() < 0.5:
                    fmu.initialize(instance, kind)
                functions = [
                    f
                    for name, f in instance._functions.items()
                    if f.restype is c_int and "Instantiate" not in name
                ]
                for _ in range(calls // 20 // len(fmu.kinds)):
                    function = rng.choice(functions)
                    arguments = [argument(rng, t, references) for t in function.argtypes[1:]]
                    status = function(instance.component, *arguments)
                    assert OK <= status <= FATAL, status


def check_storm(fmu):
    """The storm in a process of its own, whose death would be seen."""
    command = [sys.executable, __file__, "--storm", str(fmu.path)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=5 * TIMEOUT)
        passed, detail = done.returncode == 0, done.stderr[-500:]
        check("random calls abort nothing", passed, "" if passed else (done.returncode, detail))
    except subprocess.TimeoutExpired:
        check("random calls abort nothing", False, "no end")


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
        print(f"{failures} failed" if failures else "all passed")
    return 1 if failures else 0


if __name__ == "__main__":
    os.environ.setdefault("PYTHONWARNINGS", "ignore")
    sys.exit(main())
