"""Progress of a call: a function of the caller's, a bar in a notebook, or a line on a terminal."""

from __future__ import annotations

import html
import sys
import time
from collections.abc import Callable
from typing import Any

#: Called with what is done, how many steps are, and of how many, if that is known.
ProgressFunction = Callable[[str, int, "int | None"], object]
#: `None`: a bar in a notebook; `True`: that, or a line on standard error; `False`: nothing.
Progress = ProgressFunction | bool | None

#: What ends sooner shows nothing, s.
PATIENCE = 0.5


def _notebook() -> bool:
    shell = sys.modules.get("IPython")
    shell = shell and shell.get_ipython()
    return shell is not None and hasattr(shell, "kernel")


class _Shown:
    """Shows progress once it has lasted for a while."""

    def __init__(self, notebook: bool) -> None:
        self._notebook = notebook
        self._began = time.monotonic()
        self._handle: Any = None

    def __call__(self, doing: str, done: int, of: int | None) -> None:
        if time.monotonic() - self._began < PATIENCE:
            return
        if not self._notebook:
            steps = f" {done}/{of}" if of else ""
            print(f"\r\x1b[K{doing}{steps}", end="", file=sys.stderr, flush=True)
            self._handle = True
            return
        from IPython.display import HTML, display

        known = f'max="{of}" value="{done}"' if of else ""
        bar = HTML(f"<progress {known}></progress> {html.escape(doing)}")
        if self._handle is None:
            self._handle = display(bar, display_id=True)
        else:
            self._handle.update(bar)

    def end(self) -> None:
        if self._handle is None:
            return
        if not self._notebook:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
            return
        from IPython.display import HTML

        self._handle.update(HTML(""))


def shown(progress: Progress) -> tuple[ProgressFunction | None, Callable[[], None]]:
    """Return the function to call with progress, and the one to call at the end."""
    notebook = _notebook()
    if progress is False or (progress is None and not notebook):
        return None, lambda: None
    if progress is None or progress is True:
        bar = _Shown(notebook)
        return bar, bar.end
    return progress, lambda: None
