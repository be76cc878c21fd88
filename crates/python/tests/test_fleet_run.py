"""How tasks are handed to workers: as many at a time as there are threads, at any moment."""

import threading

import pytest

import airball as ab

distributed = pytest.importorskip("distributed")
from airball.fleet._run import Task, results  # noqa: E402


#: Tasks that run now, and the most that ran at a time: the workers are threads of this process.
BUSY = {"now": 0, "most": 0}
CHANGED = threading.Condition()


def busy(number):
    """All tasks but the first end when three have run at a time, which no delay of the machine can prevent."""
    with CHANGED:
        BUSY["now"] += 1
        BUSY["most"] = max(BUSY.values())
        CHANGED.notify_all()
        if number > 0:
            CHANGED.wait_for(lambda: BUSY["most"] == 3, timeout=60)
        BUSY["now"] -= 1
    if number == 1:
        raise OSError("a fault of its own")
    return number


@pytest.fixture
def cluster():
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:
        yield cluster, client


def test_workers_that_come_later_get_tasks_and_a_fault_of_one_is_its_own(cluster):
    cluster, client = cluster
    done = []
    for result in results(client, busy, [Task(str(number), (number,)) for number in range(9)]):
        if not done:
            assert BUSY["most"] == 1
            cluster.scale(3)
            client.wait_for_workers(3)
        done.append(result)
    assert BUSY["most"] == 3
    assert sorted(result.name for result in done) == [str(number) for number in range(9)], "each once"
    assert {result.name: result.reason for result in done if result.reason} == {"1": "1: OSError: a fault of its own"}
    assert all(result.result == int(result.name) for result in done if not result.reason)


def test_a_scheduler_that_does_not_answer_is_told():
    class Client:
        loop = object()

        def nthreads(self):
            raise OSError("timed out")

    with pytest.raises(ab.Error, match="^the connection to the scheduler is lost"):
        list(results(Client(), abs, [Task("a", (1,))]))


def test_the_table_of_many_logs_is_written_in_parts_and_read_as_one(tmp_path, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    from airball import fleet

    monkeypatch.setattr(fleet, "_ROWS", 2)
    names = [f"{number}.csv" for number in range(5)]
    for name in names:
        (tmp_path / f"{name}.error").write_text(f"{name}: no\n")
    fleet._table(tmp_path, [*names, "without reports.csv"])
    assert parquet.ParquetFile(tmp_path / "results.parquet").num_row_groups == 3
    frame = fleet.Finished(tmp_path, 0, 0, 5).to_frame()
    assert list(frame["log"]) == names and list(frame["error"]) == [f"{name}: no" for name in names]
