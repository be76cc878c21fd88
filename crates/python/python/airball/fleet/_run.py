"""Tasks on the workers of Dask: each is done once, whatever happens to the workers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any, NamedTuple

from ..errors import Error

#: What a user is told where the scheduler does not answer any more.
_GONE = "the connection to the scheduler is lost; what is written is kept, and the same call goes on from there"
#: Tasks for each thread that are under way: one runs, and the next one is there when it ends.
_AHEAD = 2


class Task(NamedTuple):
    """What `work(*arguments)` is called with."""

    name: str
    arguments: tuple[Any, ...]


class Done(NamedTuple):
    """The result of a task, or the reason why there is none."""

    name: str
    result: Any
    reason: str


def results(client: Any, work: Callable[..., Any], tasks: Iterable[Task]) -> Iterator[Done]:
    """The results in the order in which they are made. A few tasks for each thread of the workers, also of workers that come
    later, are under way at a time, so that the scheduler's memory does not grow with their number. Dask blames a worker's
    death on all that it held, so a task that is blamed is tried again when nothing else runs."""
    from distributed import KilledWorker, as_completed

    blamed: list[Task] = []
    under_way: dict[str, Task] = {}
    waiting, finished = iter(tasks), as_completed(loop=client.loop)

    def submit(task: Task) -> Any:
        return client.submit(work, *task.arguments, pure=False)

    def fill() -> None:
        room = max(1, _AHEAD * _threads(client)) - len(under_way)
        for task in islice(waiting, max(0, room)):
            future = submit(task)
            under_way[future.key] = task
            finished.add(future)

    fill()
    for future in finished:
        task = under_way.pop(future.key)
        try:
            yield _done(task, future)
        except KilledWorker:
            blamed.append(task)
        future.release()
        fill()
    for task in blamed:
        try:
            yield _done(task, submit(task))
        except KilledWorker as killed:
            deaths = killed.allowed_failures + 1
            yield Done(task.name, None, f"{task.name}: its worker died {deaths} times; it may need more memory, the log of the worker says why")


def _threads(client: Any) -> int:
    """The threads of the workers that are there now."""
    try:
        return sum(client.nthreads().values())
    except OSError as error:
        raise Error(_GONE) from error


def _done(task: Task, future: Any) -> Done:
    """The result of a task. A fault of one task must not take the others with it."""
    from distributed import CancelledError, KilledWorker

    try:
        return Done(task.name, future.result(), "")
    except KilledWorker:
        raise
    except CancelledError as error:
        raise Error(_GONE) from error
    except Exception as error:
        return Done(task.name, None, f"{task.name}: {type(error).__name__}: {error}")
