"""Files of results: whole whenever they are there."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def part_of(path: Path) -> Iterator[Path]:
    """The name under which a file is written before it gets its own; what is left of a failed one is removed."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield part
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, text: str) -> None:
    """Writes a file in place of one that exists."""
    with part_of(path) as part:
        part.write_text(text, encoding="utf-8")
        part.replace(path)


def write_new(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file that does not exist yet; one that exists is kept, with a `FileExistsError`."""
    path = Path(path)
    # Takes the name, so that two programs cannot both have it.
    with open(path, "xb"), part_of(path) as part:
        try:
            part.write_bytes(content)
            part.replace(path)
        except BaseException:
            path.unlink(missing_ok=True)
            raise
