"""Workers for a run: processes on this machine, or jobs of Slurm. Each has one thread, and the variables `ENVIRONMENT`."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .._extras import extra
from ..errors import Error

#: Deaths of its worker that a log may outlive.
DEATHS = 2
#: Dask samples the stack of a worker 100 times a second, and looks at its loop 50 times, which is 3 % of a processor.
_QUIET = {"distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "1s"}
#: Variables to start a worker with: one thread for a diagnosis, and little that the worker does beside.
ENVIRONMENT = {"RAYON_NUM_THREADS": "1"} | {
    f"DASK_{key.replace('.', '__').upper()}": str(value) for key, value in _QUIET.items()
}


@contextmanager
def local(workers: int, memory_limit: str | int = "auto") -> Iterator[Any]:
    """A client of so many worker processes on this machine, each with one thread."""
    with extra("fleet"):
        import dask
        from distributed import Client, LocalCluster
    environment = {f"distributed.nanny.pre-spawn-environ.{name}": value for name, value in ENVIRONMENT.items()}
    with (
        dask.config.set(_scheduling() | environment),
        LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, memory_limit=memory_limit, dashboard_address=None
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def slurm(workers: int, *, memory: str | None = None, **options: Any) -> Iterator[Any]:
    """A client of so many jobs of Slurm with a worker each. A job that ends, as at its walltime, is submitted again.

    `memory` of a job [2GB], `walltime`, `queue`, `account` and further `options` are those of `dask_jobqueue.SLURMCluster`;
    where they are not given, its config file `~/.config/dask/jobqueue.yaml` has them.
    """
    with extra("fleet", "slurm"):
        import dask
        from dask_jobqueue import SLURMCluster
        from distributed import Client
    if shutil.which("sbatch") is None:
        raise Error("there is no sbatch on this machine; run this where jobs are submitted to Slurm")
    memory = memory or dask.config.get("jobqueue.slurm.memory", None) or "2GB"
    exports = [f"export {name}={value}" for name, value in ENVIRONMENT.items()]
    own = options.pop("job_script_prologue", None) or dask.config.get("jobqueue.slurm.job-script-prologue", None) or []
    with (
        dask.config.set(_scheduling()),
        SLURMCluster(cores=1, processes=1, memory=memory, job_script_prologue=[*own, *exports], **options) as cluster,
        Client(cluster) as client,
    ):
        _check_job(cluster.job_script())
        cluster.adapt(minimum_jobs=workers, maximum_jobs=workers)
        yield client


def _scheduling() -> dict[str, Any]:
    """Settings of the scheduler, which is in this process."""
    return {"distributed.scheduler.allowed-failures": DEATHS} | _QUIET


def _check_job(script: str) -> None:
    """Refuses a job that Slurm would refuse: it would be submitted again and again."""
    tried = subprocess.run(["sbatch", "--test-only"], input=script, capture_output=True, text=True, check=False)
    if tried.returncode:
        raise Error(f"Slurm refuses the job: {tried.stderr.strip()}; check memory, walltime, partition and account")
