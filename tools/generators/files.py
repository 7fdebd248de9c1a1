"""What is written of a case: CSV recordings, a drive file to start from, the truth."""

import json
from pathlib import Path

UNITS = {
    **{"time": "s", "u": "V", "i": "A"},
    **{"omega": "rad/s", "theta": "rad", "v": "m/s", "x": "m"},
}


def replace(path, text):
    """Writes beside the file first, so that nobody reads half of one."""
    path = Path(path)
    beside = path.with_name(path.name + ".part")
    beside.write_text(text, encoding="utf-8")
    beside.replace(path)


def csv(columns, period, by_current=False):
    """Text of a recording; 9 digits are more than any sensor has."""
    units = UNITS | ({"u": "A"} if by_current else {})
    rows = [",".join(f"{name} [{units[name]}]" for name in ["time", *columns])]
    for k, values in enumerate(zip(*columns.values(), strict=True)):
        rows.append(f"{k * period:.9g}," + ",".join(f"{value:.9g}" for value in values))
    return "\n".join(rows) + "\n"


def rotary_drive(name, start):
    """A first drive file: motor and Coulomb friction, one K for torque and back-EMF."""
    return f"""schema = 1
name = "{name}"
motion = "rotary"

[motor]
input = "voltage"
R = {start["R"]!r}
L = {start["L"]!r}
K_e = {start["K"]!r}
K_m = {start["K"]!r}
J = {start["J"]!r}
B_m = {start["B"]!r}
tie_K = true

[[effect]]
kind = "coulomb"
T_c = {start["T_c"]!r}
"""


def force_drive(name, start, motion):
    """A first drive file of what is driven by a force, a torque or their current."""
    return f"""schema = 1
name = "{name}"
motion = "{motion}"

[motor]
input = "force"
K_m = {start["K"]!r}
J = {start["J"]!r}
B_m = {start["B"]!r}

[[effect]]
kind = "coulomb"
T_c = {start["T_c"]!r}
"""


def drive_file(case):
    """The first drive file of a case."""
    if case.motion == "linear" or case.by_current:
        return force_drive(case.name, case.start, case.motion)
    return rotary_drive(case.name, case.start)


def write(case, folder, columns=None):
    """Folder `folder/NAME` with drive.toml, truth.json and a CSV for every recording."""
    target = Path(folder) / case.name
    target.mkdir(parents=True, exist_ok=True)
    replace(target / "drive.toml", drive_file(case))
    for kind, recording in case.recordings.items():
        kept = {name: v for name, v in recording.items() if columns is None or name in columns}
        replace(target / f"{kind}.csv", csv(kept, case.period, case.by_current))
    replace(target / "truth.json", json.dumps(case.truth, indent=1) + "\n")
    return target
