"""Wrong calls: each has its status and its message, and the right ones go on working."""

import math
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_size_t, c_void_p

from .fmu import DISCARD, ERROR, FATAL, OK, REAL, check


def wrong_calls(fmu, instance):
    """(what, call, expected status) in a Co-Simulation instance; order matters."""
    c = instance.component

    def call(name, *arguments):
        return fmu.call(instance, name, c, *arguments)

    real = "Real" if fmu.two else "Float64"
    output = fmu.references(
        lambda v: v.causality == "output" and v.initial == "calculated" and v.type in REAL
    )
    inputs = fmu.references(lambda v: v.causality == "input" and v.type in REAL)
    fixed = fmu.references(
        lambda v: v.causality == "parameter" and v.variability == "fixed" and v.type in REAL
    )
    parameter = fmu.references(lambda v: v.causality == "parameter" and v.type in REAL)
    constant = fmu.references(lambda v: v.variability == "constant" and v.type in REAL)
    uint32 = instance._functions[fmu.prefix + "Get" + real].argtypes[1]._type_

    def access(verb, references, values, kind=real):
        n = len(references)
        array = (uint32 * n)(*references)
        function = instance._functions[f"{fmu.prefix}{verb}{kind}"]
        buffer = (function.argtypes[3]._type_ * n)(*values)
        return call(verb + kind, array, n, buffer, *([] if fmu.two else [n]))

    flags = (
        () if fmu.two else (byref(c_bool()), byref(c_bool()), byref(c_bool()), byref(c_double()))
    )

    def step(t, h):
        return call("DoStep", t, h, 1, *flags)

    state = c_void_p(987654321)
    spelled = (
        ("FMUstate", "SerializedFMUstateSize", "DeSerializeFMUstate")
        if fmu.two
        else ("FMUState", "SerializedFMUStateSize", "DeserializeFMUState")
    )
    byte = instance._functions[fmu.prefix + spelled[2]].argtypes[1]._type_
    start, h = fmu.start, fmu.step

    yield "step before initialization", lambda: step(start, h), ERROR
    if fmu.two:
        yield (
            "initialization without experiment",
            lambda: call("EnterInitializationMode"),
            ERROR,
        )
        yield "get before initialization", lambda: access("Get", output[:1], [0]), ERROR
        yield (
            "experiment that starts at NaN",
            lambda: call("SetupExperiment", 0, 0.0, math.nan, 0, 0.0),
            ERROR,
        )
    yield "terminate before initialization", lambda: call("Terminate"), ERROR
    yield "exit of a mode not entered", lambda: call("ExitInitializationMode"), ERROR
    if parameter:
        yield (
            "parameter that is NaN",
            lambda: access("Set", parameter[:1], [math.nan]),
            ERROR,
        )
    yield "initialization", lambda: fmu.initialize(instance, "CoSimulation") or OK, OK
    yield (
        "second experiment",
        lambda: (
            call("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
            if fmu.two
            else call("EnterInitializationMode", False, 0.0, 0.0, False, 0.0)
        ),
        ERROR,
    )
    yield "unknown value reference", lambda: access("Get", [4_000_000_000], [0]), ERROR
    yield (
        "value of the wrong type",
        lambda: access("Get", output[:1], [0], "Boolean"),
        ERROR,
    )
    yield (
        "NULL references",
        lambda: call("Get" + real, None, 1, (c_double * 1)(), *([] if fmu.two else [1])),
        ERROR,
    )
    yield (
        "NULL values",
        lambda: call("Get" + real, (uint32 * 1)(*output[:1]), 1, None, *([] if fmu.two else [1])),
        ERROR,
    )
    yield (
        "no values at all",
        lambda: call("Get" + real, None, 0, None, *([] if fmu.two else [0])),
        OK,
    )
    if not fmu.two:
        yield (
            "array of the wrong length",
            lambda: call("GetFloat64", (uint32 * 1)(*output[:1]), 1, (c_double * 2)(), 2),
            ERROR,
        )
        yield (
            "clock",
            lambda: call("GetClock", (uint32 * 1)(*output[:1]), 1, (c_bool * 1)()),
            ERROR,
        )
        yield "event mode", lambda: call("EnterEventMode"), ERROR
        yield "configuration mode", lambda: call("EnterConfigurationMode"), ERROR
    if output:
        yield "output set", lambda: access("Set", output[:1], [1.0]), ERROR
    if constant:
        yield "constant set", lambda: access("Set", constant[:1], [1.0]), ERROR
    if fixed:
        yield (
            "fixed parameter set after initialization",
            lambda: access("Set", fixed[:1], [1.0]),
            ERROR,
        )
    if inputs:
        for value in (math.nan, math.inf):
            yield (
                f"input {value}",
                lambda value=value: access("Set", inputs[:1], [value]),
                ERROR,
            )
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
    yield (
        "free of a foreign state",
        lambda: call("Free" + spelled[0], byref(state)),
        ERROR,
    )
    yield (
        "size of a foreign state",
        lambda: call(spelled[1], state, byref(c_size_t())),
        ERROR,
    )
    yield (
        "bytes that are no state",
        lambda: call(spelled[2], (byte * 9)(), 9, byref(c_void_p())),
        ERROR,
    )
    yield (
        "unknown log category",
        lambda: call("SetDebugLogging", 1, 1, (c_char_p * 1)(b"nonsense")),
        ERROR,
    )
    yield (
        "Model Exchange function",
        lambda: instance.dll[fmu.prefix + "EnterContinuousTimeMode"](c_void_p(c)),
        ERROR,
    )
    if fmu.two:
        yield (
            "status of no pending step",
            lambda: call("GetStatus", 0, byref(c_int())),
            DISCARD,
        )
        yield (
            "input derivatives",
            lambda: call("SetRealInputDerivatives", None, 0, None, None),
            ERROR,
        )
        yield "cancel of no step", lambda: call("CancelStep"), ERROR
    yield "right step after all this", lambda: step(start, h), OK
    yield "terminate", lambda: call("Terminate"), OK
    yield "step after terminate", lambda: step(start + h, h), ERROR
    yield "get after terminate", lambda: access("Get", output[:1], [0]), OK
    yield "reset", lambda: call("Reset"), OK
    yield (
        "run after reset",
        lambda: fmu.initialize(instance, "CoSimulation") or step(start, h),
        OK,
    )
    boom = fmu.references(lambda v: v.name == "panics")
    if boom:
        yield "panic armed", lambda: access("Set", boom, [1], "Boolean"), OK
        yield "panic", lambda: step(start + h, h), FATAL
        yield "call after panic", lambda: call("Reset"), FATAL


def check_wrong_calls(fmu):
    """Each wrong call has its status and a message, whether or not debugging is logged."""
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
                if expected != OK and not told:
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
