"""Which spoilings there are, what goes with what, and files drawn from them."""

from dataclasses import dataclass, field

import numpy as np

from . import clean, layout, naming, timing

MOST = 4
"""Spoilings of one file."""

TIMING = {function.__name__: function for function in timing.ORDER}
CLOCKS = ["epoch_stamps", "iso_stamps", "clock_over_midnight", "time_units"]
ENCODINGS = ["windows_1252", "utf_16", "byte_order_mark"]
LANGUAGES = ["german", "french", "spanish", "italian", "camel"]
TEXT = [
    *ENCODINGS,
    "other_delimiter",
    "blanks",
    "decimal_comma",
    "declared_delimiter",
    "preamble",
    "unit_row",
    "unit_marks",
    "trailing_delimiter",
    "footer",
    "comment_lines",
    "repeated_header",
    "quoted_fields",
    "thousands",
    "line_ends",
    "missing_values",
    "text_column",
    "constant_column",
    "empty_column",
    *LANGUAGES,
    "foreign_units",
    "shuffled_columns",
    "unknown_columns",
]
ALL = [*TIMING, *CLOCKS, *TEXT]

CONFLICTS = [
    # One of a kind.
    {*CLOCKS},
    {*ENCODINGS},
    {*LANGUAGES},
    {"jittered_instants", "jittered_stamps"},
    {"unit_row", "unit_marks"},
    # Stamps that are wrong tell nothing of instants, nor of what was lost or swapped between.
    {"jittered_instants", "late_bursts"},
    {"jittered_instants", "coarse_stamps"},
    {"coarse_stamps", "late_bursts"},
    {"coarse_stamps", "lost_samples"},
    {"coarse_stamps", "joined_rates"},
    {"coarse_stamps", "disorder"},
    # Rows alike under one stamp may be those of a machine at rest.
    {"coarse_stamps", "repeated_rows"},
    {"late_bursts", "disorder"},
    {"jittered_stamps", "coarse_stamps"},
    # Dates and times of day do not start again.
    {"run_restart", "epoch_stamps"},
    {"run_restart", "iso_stamps"},
    {"run_restart", "clock_over_midnight"},
    # Two headers may mean two runs.
    {"repeated_header", "run_number"},
    {"repeated_header", "repeated_rows"},
    {"repeated_header", "disorder"},
    # Between blanks nothing can be empty or blank.
    *({"blanks", other} for other in ("other_delimiter", "decimal_comma", "declared_delimiter")),
    *({"blanks", other} for other in ("trailing_delimiter", "empty_column", "thousands")),
    # A date with grouped digits is none.
    {"thousands", "epoch_stamps"},
]


@dataclass
class Draft:
    """A file before it is written."""

    rng: np.random.Generator
    clean: clean.Clean
    log: timing.Log
    naming: naming.Naming
    layout: layout.Layout
    spoilings: list
    clock: str = None
    extra: list = field(default_factory=list)
    shuffled: bool = False
    done: dict = field(default_factory=dict)
    """What every spoiling did."""

    def has(self, name):
        return name in self.spoilings


def draw(rng, allowed):
    """Names of one to four spoilings that go with each other."""
    drawn = []
    for name in rng.permutation(allowed)[: 3 * MOST].tolist():
        apart = any(len({name, *drawn} & set_) > 1 and name in set_ for set_ in CONFLICTS)
        if not apart:
            drawn.append(name)
    return drawn[: int(rng.integers(1, MOST + 1))]


def draft(rng, kind, spoilings):
    """A file of that kind with these spoilings, ready to be written."""
    made = clean.make(rng, kind)
    log = timing.of(made, rng)
    here = Draft(rng, made, log, naming.Naming(rng), layout.Layout(rng), spoilings)
    if here.has("coarse_stamps"):
        log.coarse = timing.drawn_tick(log)
    if here.has("lost_samples"):
        # Beside a lost sample a stamp has to be nearest to its own.
        log.latest = 0.45
    for name, spoil in TIMING.items():
        if here.has(name):
            here.done[name] = spoil(log)
    if log.order is None:
        log.order = np.arange(len(log.t))
    for name in CLOCKS:
        if here.has(name):
            here.clock = name
    if kind == "epoch" and here.clock is None and not here.has("run_restart"):
        if not here.has("thousands"):
            here.clock = "epoch_stamps"
    for name in TEXT:
        if here.has(name):
            here.done[name] = TEXTS[name](here)
    return here


def _windows_1252(here):
    here.layout.encoding = "cp1252"
    here.extra.append("note")


def _utf_16(here):
    here.layout.encoding = str(here.rng.choice(["utf-16-le", "utf-16-be"]))
    here.layout.bom = "\ufeff".encode(here.layout.encoding)
    return {"encoding": here.layout.encoding}


def _byte_order_mark(here):
    here.layout.bom = b"\xef\xbb\xbf"


def _other_delimiter(here):
    here.layout.delimiter = str(here.rng.choice([";", "\t", "|"]))
    return {"delimiter": here.layout.delimiter}


def _blanks(here):
    here.layout.delimiter = " "


def _decimal_comma(here):
    here.layout.comma = True
    if here.layout.delimiter == ",":
        here.layout.delimiter = str(here.rng.choice([";", "\t"]))


def _declared_delimiter(here):
    here.layout.declared = True
    if here.layout.delimiter == ",":
        here.layout.delimiter = ";"


def _preamble(here):
    here.layout.preamble = str(here.rng.choice(list(layout.PREAMBLES)))
    return {"preamble": here.layout.preamble}


def _unit_row(here):
    here.layout.unit_row = True
    here.naming.style = "row"


def _unit_marks(here):
    here.naming.style = str(here.rng.choice(["()", "_", "/"]))
    return {"marks": here.naming.style}


def _trailing_delimiter(here):
    here.layout.trailing = True


def _footer(here):
    here.layout.footer = str(here.rng.choice(layout.FOOTERS))
    return {"footer": here.layout.footer}


def _comment_lines(here):
    here.layout.comments = True


def _repeated_header(here):
    """Where a run begins, or every page of a print."""
    starts = np.flatnonzero(np.diff(here.log.run)) + 1
    if len(starts) == 0:
        page = int(here.rng.integers(500, 1200))
        starts = np.arange(page, len(here.log.t), page)
    here.layout.headers = starts.tolist()
    return {"headers": len(starts)}


def _quoted_fields(here):
    here.layout.quoted = str(here.rng.choice(["all", "names"]))
    return {"quoted": here.layout.quoted}


def _thousands(here):
    marks = [".", " ", "'"] if here.layout.comma else [",", " ", "'"]
    here.layout.thousands = str(here.rng.choice(marks))
    if here.layout.thousands == "," and here.layout.delimiter == ",":
        here.layout.delimiter = ";"
    here.naming.foreign = True
    return {"mark": here.layout.thousands}


def _line_ends(here):
    here.layout.line_end = str(here.rng.choice(["\r\n", "\r"]))
    return {"line_end": here.layout.line_end}


def _missing_values(here):
    texts = ["NaN", "---", "#N/A", "NULL"] + ([] if here.has("blanks") else [""])
    here.layout.missing = str(here.rng.choice(texts))
    return {"text": here.layout.missing}


def _column(name):
    return lambda here: here.extra.append(name)


def _language(name):
    def speak(here):
        here.naming.language = name

    return speak


def _foreign_units(here):
    here.naming.foreign = True


def _shuffled_columns(here):
    here.shuffled = True


TEXTS = {name[1:]: function for name, function in globals().items() if name[1:] in TEXT}
TEXTS |= {name: _language(name) for name in LANGUAGES}
TEXTS |= {"text_column": _column("text"), "constant_column": _column("constant")}
TEXTS |= {"empty_column": _column("empty"), "unknown_columns": _column("unknown")}
