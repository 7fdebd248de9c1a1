"""NULL instances, missing resources, random calls: nothing may end the importer."""

import math
import random
import shutil
import subprocess
import sys
from ctypes import POINTER, byref, c_bool, c_char_p, c_double, c_int, c_void_p, cast
from pathlib import Path

from fmpy.fmi1 import FMICallException

from .fmu import ERROR, FATAL, OK, TIMEOUT, check

SCRIPT = Path(__file__).resolve().parent.parent / "check_export.py"


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
            made = functions["fmi2Instantiate"](
                name,
                int(fmu.kinds[0] == "CoSimulation"),
                token,
                None,
                byref(instance.callbacks),
                0,
                0,
            )
            none = functions["fmi2Instantiate"](name, 1, token, None, None, 0, 0)
            check("without callbacks", not none)
        else:
            log = instance.logMessage
            if fmu.kinds[0] == "CoSimulation":
                make = functions["fmi3InstantiateCoSimulation"]
                made = make(
                    name,
                    token,
                    None,
                    False,
                    False,
                    False,
                    False,
                    None,
                    0,
                    None,
                    log,
                    instance.intermediateUpdate,
                )
                event = make(
                    name,
                    token,
                    None,
                    False,
                    False,
                    True,
                    False,
                    None,
                    0,
                    None,
                    log,
                    instance.intermediateUpdate,
                )
                check("event mode, which is not offered, is refused", not event)
            else:
                made = functions["fmi3InstantiateModelExchange"](
                    name, token, None, False, False, None, log
                )
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
    command = [sys.executable, str(SCRIPT), "--storm", str(fmu.path)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=5 * TIMEOUT, check=False
        )
        passed, detail = done.returncode == 0, done.stderr[-500:]
        check(
            "random calls abort nothing",
            passed,
            "" if passed else (done.returncode, detail),
        )
    except subprocess.TimeoutExpired:
        check("random calls abort nothing", False, "no end")
