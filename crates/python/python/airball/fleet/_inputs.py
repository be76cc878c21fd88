"""Logs by path, pattern or URL: found by the client, read by the workers."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from .. import _airball
from .._extras import extra
from ..errors import Error, MissingLibraryError, UsageError


@dataclass(frozen=True)
class Remote:
    """A file of a file system of fsspec. A worker makes a connection of its own, with the credentials that it has."""

    files: Any
    path: str

    @contextmanager
    def copied(self) -> Iterator[str]:
        """A copy on this machine, for as long as it is read."""
        with tempfile.TemporaryDirectory(prefix="airball-") as folder:
            copy = os.path.join(folder, PurePosixPath(self.path).name)
            try:
                self.files.get_file(self.path, copy)
            except Exception as error:
                raise Error(f"cannot fetch {self.path}: {type(error).__name__}: {error}") from error
            yield copy


#: A path on this machine, or a file elsewhere.
Place = str | Remote


@contextmanager
def local_copy(place: Place) -> Iterator[str]:
    """The path of a log on this machine."""
    if isinstance(place, Remote):
        with place.copied() as path:
            yield path
    else:
        yield place


def find(given: Sequence[str]) -> list[tuple[str, Place]]:
    """The logs that are named, match a pattern or lie in a named folder, in the order of their names."""
    plain = [path for path in given if os.path.exists(path) or not _is_url(path) and not _is_pattern(path)]
    found: list[tuple[str, Place]] = [
        (name, os.path.abspath(path)) for name, path in (_airball.tell_apart(plain) if plain else [])
    ]
    for other in given:
        if other not in plain:
            found += _matching(other)
    by_name: dict[str, Place] = {}
    for name, place in found:
        if by_name.setdefault(name, place) != place:
            raise UsageError(f"{_shown(by_name[name])} and {_shown(place)} have one name; name the folder that holds both")
    return sorted(by_name.items(), key=lambda log: log[0])


def _is_url(path: str) -> bool:
    return "://" in path


def _is_pattern(path: str) -> bool:
    return any(character in path for character in "*?[")


def _shown(place: Place) -> str:
    return place.path if isinstance(place, Remote) else place


def _matching(given: str) -> list[tuple[str, Place]]:
    """The logs of a pattern or a URL. The name of a log is its path below the part that holds no pattern."""
    files, path = _opened(given)
    if _is_pattern(path):
        root = path[: min(path.find(character) for character in "*?[" if character in path)].rpartition("/")[0]
        below = [file for file, about in files.glob(path, detail=True).items() if about["type"] == "file"]
    elif files.isfile(path):
        return [(PurePosixPath(path).name, _place(files, path))]
    else:
        root, below = path, files.find(path)
    logs = {file[len(root) :].lstrip("/"): _place(files, file) for file in below if _airball.is_log(file)}
    if not logs:
        raise UsageError(f"{given}: no log is in there; check the name, and that this machine may read it")
    for name in logs:
        if ".." in PurePosixPath(name).parts:
            raise UsageError(f"{given}: the log {name!r} has '..' in its name, which leads out of the folder of reports")
    return list(logs.items())


def _place(files: Any, path: str) -> Place:
    return path if "file" in files.protocol else Remote(files, path)


def _opened(given: str) -> tuple[Any, str]:
    """The file system of a URL, and the path in it."""
    with extra("fleet", "s3"):
        import fsspec.core

        try:
            return fsspec.core.url_to_fs(given)  # type: ignore[no-any-return]
        except ImportError as error:
            # fsspec says what to install, and hides the module behind an error of its own.
            if getattr(error.__cause__, "name", None) == "s3fs":
                raise error.__cause__ from None  # type: ignore[misc]
            raise MissingLibraryError(f"{given}: {error}") from None
        except ValueError as error:
            raise UsageError(f"{given}: {error}") from None
