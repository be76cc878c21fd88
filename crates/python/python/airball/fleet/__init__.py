"""Many logs on many processes or machines, by Dask: `airball diagnose --each`, with one log a task.

The files are those of the command: for each log `NAME.json` and `NAME.html`, or `NAME.error` with the reason; then
`summary.csv` and `index.html` of all, and beside them `results.parquet`. A log with a JSON is done, so a run that was
stopped goes on. Workers are to have one thread each and the variables `ENVIRONMENT`; `local` and `slurm` start such ones.

`across` compares the rigs of such a folder with each other and over time.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import _airball
from .._extras import extra
from .._files import part_of, write_whole
from .._diagnosis import diagnose as _diagnose
from .._model import Model, _Path
from .._recording import Recording, model_of
from ..errors import ArgumentError, Error
from ._clusters import DEATHS, ENVIRONMENT, local, slurm
from ._inputs import Place, find, local_copy
from ._run import Task, results

if TYPE_CHECKING:
    from ._across import Across, across

__all__ = ["DEATHS", "ENVIRONMENT", "Across", "Finished", "across", "diagnose", "local", "report", "slurm"]


def __getattr__(name: str) -> Any:
    """`Across` and `across`, once they are asked for: they need SciPy, which workers do without."""
    if name in ("Across", "across"):
        with extra("fleet"):
            from . import _across
        return getattr(_across, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


#: Rows of the table that are held in memory at a time, each with a document.
_ROWS = 1000


@dataclass(frozen=True)
class Finished:
    """What there is after a run."""

    #: Folder of the reports.
    out: Path
    #: Logs with an answer, logs that cannot answer (`insufficient_data`), and logs that cannot be read or diagnosed.
    diagnosed: int
    cannot_answer: int
    failed: int

    def to_frame(self) -> Any:
        """A row for each log, as a frame of pandas."""
        import pandas

        return pandas.read_parquet(self.out / "results.parquet")


def report(model: Model, place: Place, name: str, flags: dict[str, Any]) -> tuple[str, str, str]:
    """What a worker does with a log: its JSON, its page, and the reason why there is none, of which one is empty."""
    path = str(place)
    try:
        with local_copy(place) as path:
            log = Recording._of(_airball.Log.read(path, model._belief).named(name))
        found = _diagnose(model, log, progress=False, **flags)
        return found.json(), found._found.page(["diagnose", "--each"]), ""
    except Error as error:
        return "", "", str(error).replace(path, name)


@extra("fleet", "slurm", "s3")
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

    A log is a path, a pattern as `logs/**/*.mcap`, or a URL of fsspec as `s3://bucket/logs`; a folder stands for the logs
    in it. The workers read them. What is in `out` already is not done again. A log whose worker dies is tried on others;
    one whose workers die again and again, also alone, is given up: a row with the reason.
    """
    belief, folder = model_of(model), Path(out)
    paths = [os.fspath(logs)] if isinstance(logs, (str, os.PathLike)) else [os.fspath(log) for log in logs]
    if not paths:
        raise ArgumentError("logs is empty; give at least one log or folder")
    named = find(paths)
    folder.mkdir(parents=True, exist_ok=True)
    flags = {"without": list(without), "without_formula": without_formula}
    todo = [
        Task(name, (belief, place, name, flags)) for name, place in named if not _file(folder, name, "json").exists()
    ]
    for name, made, reason in results(client, report, todo):
        document, page, error = made or ("", "", reason)
        _write(folder, name, document, page, error)
    names = [name for name, _ in named]
    counts = _airball.summarise(names, os.fspath(folder))
    _table(folder, names)
    return Finished(folder, *counts)


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

    rows = (row for name in names if (row := _row(folder, name)) is not None)
    schema = pyarrow.schema(
        [("log", "string"), ("verdict", "string"), ("effect", "string"), ("probability", "float64")]
        + [(key, "float64") for key in ("believed_1s_mm", "mended_1s_mm", "noise_1s_mm", "closed")]
        + [("document", "string"), ("error", "string")]
    )
    path = folder / "results.parquet"
    with part_of(path) as part:
        with pyarrow.parquet.ParquetWriter(part, schema) as table:
            while some := list(islice(rows, _ROWS)):
                table.write_table(pyarrow.Table.from_pylist(some, schema))
        part.replace(path)


def _numbers(text: str) -> dict[str, Any]:
    """The columns of a diagnosis."""
    found = json.loads(text)
    first = next(iter(found["effects"]), {})
    gap = found["gap"]
    return {
        "verdict": found["verdict"],
        "effect": first.get("name"),
        "probability": first.get("probability"),
        "believed_1s_mm": gap["nominal_mm"][2],
        "mended_1s_mm": gap["mended_mm"][2],
        "noise_1s_mm": gap["floor_mm"][2],
        "closed": (gap["closed"] or {}).get("value"),
        "document": text,
    }


def _row(folder: Path, name: str) -> dict[str, Any] | None:
    document, error = _file(folder, name, "json"), _file(folder, name, "error")
    if document.exists():
        try:
            return {"log": name} | _numbers(document.read_text(encoding="utf-8"))
        except (ValueError, LookupError, TypeError, AttributeError) as why:
            return {"log": name, "error": f"{document} is damaged ({why!r}); delete it and run again"}
    if error.exists():
        return {"log": name, "error": error.read_text(encoding="utf-8").strip()}
    return None
