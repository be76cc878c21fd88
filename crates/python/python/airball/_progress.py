"""Progress of a diagnosis: a bar in a notebook or on a terminal, or a function of the caller."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Heard = Callable[[int, int, str], None]

#: Time between two frames of a bar, seconds.
_FRAME_S = 0.2


@contextmanager
def shown(progress: bool | Heard | None) -> Iterator[Heard | None]:
    """What is called with the progress, and cleared afterwards."""
    if callable(progress):
        yield progress
        return
    in_notebook = _in_notebook()
    if not (in_notebook if progress is None else progress):
        yield None
        return
    bar = _NotebookBar() if in_notebook else _TerminalBar()
    last = 0.0

    def heard(made: int, planned: int, step: str) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _FRAME_S:
            last = now
            bar.show(made, planned, step)

    try:
        yield heard
    finally:
        bar.clear()


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    instance = shell.get_ipython() if shell is not None else None
    return type(instance).__name__ == "ZMQInteractiveShell"


class _NotebookBar:
    def __init__(self) -> None:
        self._handle: Any = None

    def show(self, made: int, planned: int, step: str) -> None:
        from IPython.display import HTML, display

        bar = HTML(f"<progress max={max(planned, 1)} value={made}></progress> {made}/{planned} fits, {step}")
        if self._handle is None:
            self._handle = display(bar, display_id=True)
        else:
            self._handle.update(bar)

    def clear(self) -> None:
        if self._handle is not None:
            from IPython.display import HTML

            self._handle.update(HTML(""))


class _TerminalBar:
    def show(self, made: int, planned: int, step: str) -> None:
        sys.stderr.write(f"\r\x1b[K{made}/{planned} fits  {step}")
        sys.stderr.flush()

    def clear(self) -> None:
        sys.stderr.write("\r\x1b[K")
        sys.stderr.flush()
