"""How results look in a notebook."""

from __future__ import annotations

import html
from collections.abc import Iterable

#: Height of a report in a notebook, pixels; it scrolls by itself.
HEIGHT = 560


def framed(page: str) -> str:
    """Return a report as a frame of its own: its style is its own, and nothing in it runs."""
    return (
        f'<iframe sandbox srcdoc="{html.escape(page)}" width="100%" height="{HEIGHT}" '
        'style="border: 1px solid #8886"></iframe>'
    )


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a table."""
    cells = "".join(f"<th>{html.escape(it)}</th>" for it in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(str(it))}</td>" for it in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"
