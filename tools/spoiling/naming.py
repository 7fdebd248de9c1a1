"""What columns are called, and the units that their values are in."""

from dataclasses import dataclass, field

import numpy as np

COUNTS = 4096
"""Counts a revolution of the encoder."""
DIGITS = 5
"""Decimal digits below the largest value that are printed."""

WORDS = {
    "english": {
        "time": ["time", "Time", "timestamp"],
        "u": ["voltage", "motor_voltage", "Voltage"],
        "i": ["current", "motor_current", "Current"],
        "omega": ["speed", "motor_speed", "angular_velocity"],
        "theta": ["angle", "shaft_angle", "Rotor angle"],
        "x": ["position", "displacement", "Position"],
        "torque": ["torque", "motor_torque", "Torque"],
        "temperature": ["temperature", "motor_temperature", "winding_temperature"],
        "T": ["tacho", "tachometer", "Tachometer"],
        "run": ["run", "trial", "test_id"],
    },
    "german": {
        "time": ["Zeit"],
        "u": ["Spannung", "Motorspannung", "Ankerspannung"],
        "i": ["Strom", "Motorstrom", "Ankerstrom"],
        "omega": ["Drehzahl", "Winkelgeschwindigkeit", "Motordrehzahl"],
        "theta": ["Winkel", "Drehwinkel"],
        "x": ["Weg", "Position", "Lage"],
        "torque": ["Drehmoment", "Motormoment"],
        "temperature": ["Temperatur", "Motortemperatur"],
        "T": ["Tacho"],
        "run": ["Versuch", "Lauf", "Versuch_Nr"],
    },
    "french": {
        "time": ["temps"],
        "u": ["tension", "tension_moteur"],
        "i": ["courant", "courant_moteur"],
        "omega": ["vitesse", "vitesse_moteur", "Vitesse mesurée"],
        "theta": ["angle", "Angle mesuré"],
        "x": ["position", "déplacement"],
        "torque": ["couple", "couple_moteur"],
        "temperature": ["température", "temperature_moteur"],
        "run": ["essai"],
    },
    "spanish": {
        "time": ["tiempo"],
        "u": ["tensión", "voltaje"],
        "i": ["corriente", "corriente_motor"],
        "omega": ["velocidad", "velocidad_motor"],
        "theta": ["ángulo"],
        "x": ["posición", "desplazamiento"],
        "torque": ["par", "par_motor"],
        "temperature": ["temperatura", "temperatura_motor"],
        "run": ["ensayo"],
    },
    "italian": {
        "time": ["tempo"],
        "u": ["tensione", "tensione_motore"],
        "i": ["corrente", "corrente_motore"],
        "omega": ["velocità", "velocità_motore"],
        "theta": ["angolo"],
        "x": ["posizione", "spostamento"],
        "torque": ["coppia", "coppia_motore"],
        "temperature": ["temperatura", "temperatura_motore"],
        "run": ["prova"],
    },
    "camel": {
        "time": ["timeStamp", "elapsedTime"],
        "u": ["motorVoltage", "armatureVoltage"],
        "i": ["motorCurrent", "measuredCurrent"],
        "omega": ["motorSpeed", "angularVelocity", "shaftSpeed"],
        "theta": ["rotorAngle", "shaftAngle"],
        "x": ["actualPosition", "linearPosition"],
        "torque": ["motorTorque", "measuredTorque"],
        "temperature": ["motorTemperature"],
        "T": ["tachoSpeed"],
        "run": ["runNumber", "testId"],
    },
}

UNITS = {
    #        texts, SI value of one, SI value of zero
    "V": [(["V"], 1.0, 0.0), (["mV"], 1e-3, 0.0)],
    "A": [(["A"], 1.0, 0.0), (["mA"], 1e-3, 0.0)],
    "rad/s": [
        (["rad/s"], 1.0, 0.0),
        (["rpm", "1/min", "U/min", "min^-1", "RPM"], np.pi / 30, 0.0),
        (["deg/s", "°/s"], np.pi / 180, 0.0),
    ],
    "rad": [
        (["rad"], 1.0, 0.0),
        (["deg", "°"], np.pi / 180, 0.0),
        (["rev"], 2 * np.pi, 0.0),
        ([f"counts/{COUNTS}", "counts"], 2 * np.pi / COUNTS, 0.0),
    ],
    "m": [(["m"], 1.0, 0.0), (["mm"], 1e-3, 0.0), (["µm", "um"], 1e-6, 0.0)],
    "N m": [
        (["N m", "Nm", "N·m"], 1.0, 0.0),
        (["mN m", "mNm"], 1e-3, 0.0),
        (["Ncm"], 1e-2, 0.0),
    ],
    "K": [(["K"], 1.0, 0.0), (["°C", "degC"], 1.0, 273.15)],
    # The tachometer stays in the unit of its file.
    "rpm": [(["rpm", "1/min"], 1.0, 0.0)],
}
PLAIN_MARKS = {"rad/s": "rad_s", "deg/s": "deg_s", "N m": "Nm", "mN m": "mNm"}
"""How these are written behind an underscore."""


@dataclass
class Column:
    """A column of the file: its name, its unit or none, its cells in the order of the file."""

    name: str
    unit: str
    cells: list
    number: bool = True


@dataclass
class Naming:
    """How columns are named."""

    rng: np.random.Generator
    language: str = None
    foreign: bool = False
    style: str = "[]"
    counts: str = None
    """Text of the unit of an encoder's counts, where there are some."""
    quanta: dict = field(default_factory=dict)
    """Of every signal, the step of its printed digits, SI."""

    def name(self, canonical):
        words = WORDS.get(self.language, {}).get(canonical)
        return str(self.rng.choice(words)) if words else canonical

    def unit(self, canonical, si):
        """Text, SI value of one, SI value of zero."""
        known = UNITS[si]
        texts, one, zero = known[
            int(self.rng.integers(1, len(known))) if self.foreign_to(si) else 0
        ]
        text = str(self.rng.choice(texts))
        if text.startswith("counts"):
            self.counts = text
        return text, one, zero

    def foreign_to(self, si):
        return self.foreign and len(UNITS[si]) > 1

    def signal(self, signal, values):
        """A signal's column; the values that are printed, SI."""
        text, one, zero = self.unit(signal.name, signal.unit)
        if text.startswith("counts"):
            decimals = 0
        else:
            largest = max(np.abs((values - zero) / one).max(), 1e-9)
            decimals = int(max(0, DIGITS - np.floor(np.log10(largest))))
        self.quanta[signal.name] = one * 10.0**-decimals
        cells = np.char.mod(f"%.{decimals}f", (values - zero) / one).tolist()
        return Column(self.name(signal.name), text, cells)

    def header(self, column, joined=False):
        """A column's header; without blanks where they part columns."""
        unit = column.unit
        if not unit:
            return column.name
        blank = "" if joined else " "
        if joined:
            unit = PLAIN_MARKS.get(unit, unit)
        match self.style:
            case "[]":
                return f"{column.name}{blank}[{unit}]"
            case "()":
                return f"{column.name}{blank}({unit})"
            case "_":
                return f"{column.name}_{PLAIN_MARKS.get(unit, unit)}"
            case "/":
                return f"{column.name}/{unit}"
            case "row":
                # Nothing would tell which blank parts names.
                return column.name.replace(" ", "_") if joined else column.name
