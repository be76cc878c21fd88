"""Many logs on many processes or machines, by Dask: `airball diagnose --each`, with one log a task.

The files are those of the command: for each log `NAME.json` and `NAME.html`, or `NAME.error` with the reason; then
`summary.csv` and `index.html` of all, and beside them `results.parquet`. A log with a JSON is done, so a run that was
stopped goes on. Workers are to have one thread each and `RAYON_NUM_THREADS=1`; `local` starts such ones.

`across` compares the rigs of such a folder with each other and over time.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import _airball
from .._diagnosis import diagnose as _diagnose
from .._model import Model, _Path
from .._recording import Recording, model_of
from ..errors import ArgumentError, Error
from ._files import write_whole

if TYPE_CHECKING:
    from ._across import Across, across

__all__ = ["DEATHS", "Across", "Finished", "across", "diagnose", "local", "report"]


def __getattr__(name: str) -> Any:
    """`Across` and `across`, once they are asked for: they need SciPy, which workers do without."""
    if name in ("Across", "across"):
        from . import _across

        return getattr(_across, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


#: Deaths of its worker that a log may outlive.
DEATHS = 2


@dataclass(frozen=True)
class Finished:
    """What there is after a run."""

    #: Folder of the reports.
    out: Path
    diagnosed: int
    failed: int

    def to_frame(self) -> Any:
        """A row for each log, as a frame of pandas."""
        import pandas

        return pandas.read_parquet(self.out / "results.parquet")


def report(model: Model, path: str, name: str, flags: dict[str, Any]) -> tuple[str, str, str]:
    """What a worker does with a log: its JSON, its page, and the reason why there is none, of which one is empty."""
    try:
        log = Recording._of(_airball.Log.read(path, model._belief).named(name))
        found = _diagnose(model, log, progress=False, **flags)
        return found.json(), found._found.page(["diagnose", "--each"]), ""
    except Error as error:
        return "", "", str(error).replace(path, name)


def diagnose(
    logs: _Path | Sequence[_Path],
    *,
    model: Model | _Path,
    out: _Path,
    client: Any,
    without: Sequence[str] = (),
    without_formula: bool = False,
) -> Finished:
    """Diagnoses each log by itself on the workers of a Dask `client`, and writes the reports into the folder `out`.

    A folder in `logs` stands for the logs in it, which the workers read by their path. What is in `out` already is not
    done again. A log whose worker dies is tried on others; one whose workers die
    again and again, also alone, is given up: a row with the reason.
    """
    belief, folder = model_of(model), Path(out)
    paths = [os.fspath(logs)] if isinstance(logs, (str, os.PathLike)) else [os.fspath(log) for log in logs]
    if not paths:
        raise ArgumentError("logs is empty; give at least one log or folder")
    named = _airball.tell_apart(paths)
    folder.mkdir(parents=True, exist_ok=True)
    todo = [(name, os.path.abspath(path)) for name, path in named if not _file(folder, name, "json").exists()]
    flags = {"without": list(without), "without_formula": without_formula}
    for name, (document, page, error) in _results(client, belief, todo, flags):
        _write(folder, name, document, page, error)
    diagnosed, failed = _airball.summarise(paths, os.fspath(folder))
    _table(folder, [name for name, _ in named])
    return Finished(folder, diagnosed, failed)


_Reports = tuple[str, str, str]


def _results(
    client: Any, belief: Model, todo: list[tuple[str, str]], flags: dict[str, Any]
) -> Iterator[tuple[str, _Reports]]:
    """The reports in the order in which they are made. One log per thread of the workers is under way at a time, so that
    the scheduler's memory does not grow with their number. Dask blames a worker's death on all that it held, so a log
    that is blamed is tried again when nothing else runs."""
    from distributed import KilledWorker, as_completed

    blamed: list[tuple[str, str]] = []
    names: dict[str, tuple[str, str]] = {}
    waiting = iter(todo)

    def submitted(log: tuple[str, str]) -> Any:
        name, path = log
        future = client.submit(report, belief, path, name, flags, pure=False)
        names[future.key] = log
        return future

    at_once = max(1, sum(client.nthreads().values()))
    under_way = as_completed([submitted(log) for log in islice(waiting, at_once)])
    for future in under_way:
        log = names.pop(future.key)
        try:
            yield log[0], _made(log[0], future)
        except KilledWorker:
            blamed.append(log)
        future.release()
        following = next(waiting, None)
        if following is not None:
            under_way.add(submitted(following))
    for log in blamed:
        try:
            yield log[0], _made(log[0], submitted(log))
        except KilledWorker as killed:
            deaths = killed.allowed_failures + 1
            yield log[0], ("", "", f"{log[0]}: its worker died {deaths} times; it may need more memory")


def _made(name: str, future: Any) -> _Reports:
    """The reports of a log. A fault of one log must not take the others with it."""
    from distributed import KilledWorker

    try:
        return tuple(future.result())  # type: ignore[return-value]
    except KilledWorker:
        raise
    except Exception as error:
        return "", "", f"{name}: {type(error).__name__}: {error}"


def _file(folder: Path, name: str, end: str) -> Path:
    return folder / f"{name}.{end}"


def _write(folder: Path, name: str, document: str, page: str, error: str) -> None:
    """The files of a log, its JSON last."""
    files = [("error", error + "\n")] if error else [("html", page), ("json", document)]
    for end, text in files:
        path = _file(folder, name, end)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
    if not error:
        _file(folder, name, "error").unlink(missing_ok=True)


def _table(folder: Path, names: list[str]) -> None:
    """A row for each log: verdict, first effect, errors 1 s ahead, the whole document, or the reason why there is none."""
    import pyarrow
    import pyarrow.parquet

    rows = [row for row in (_row(folder, name) for name in names) if row is not None]
    schema = pyarrow.schema(
        [("log", "string"), ("verdict", "string"), ("effect", "string"), ("probability", "float64")]
        + [(key, "float64") for key in ("believed_1s_mm", "mended_1s_mm", "noise_1s_mm", "closed")]
        + [("document", "string"), ("error", "string")]
    )
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist(rows, schema), folder / "results.parquet")


def _row(folder: Path, name: str) -> dict[str, Any] | None:
    document, error = _file(folder, name, "json"), _file(folder, name, "error")
    if document.exists():
        text = document.read_text(encoding="utf-8")
        found = json.loads(text)
        first = next(iter(found["effects"]), {})
        gap = found["gap"]
        return {
            "log": name,
            "verdict": found["verdict"],
            "effect": first.get("name"),
            "probability": first.get("probability"),
            "believed_1s_mm": gap["nominal_mm"][2],
            "mended_1s_mm": gap["mended_mm"][2],
            "noise_1s_mm": gap["floor_mm"][2],
            "closed": (gap["closed"] or {}).get("value"),
            "document": text,
        }
    if error.exists():
        return {"log": name, "error": error.read_text(encoding="utf-8").strip()}
    return None


@contextmanager
def local(workers: int, memory_limit: str | int = "auto") -> Iterator[Any]:
    """A client of so many worker processes on this machine, each with one thread."""
    import dask
    from distributed import Client, LocalCluster

    settings = {
        "distributed.nanny.pre-spawn-environ.RAYON_NUM_THREADS": "1",
        "distributed.scheduler.allowed-failures": DEATHS,
    }
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, memory_limit=memory_limit, dashboard_address=None
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client
