"""Workers for a run: processes on this machine, or jobs of Slurm. Each has one thread, and `RAYON_NUM_THREADS=1`."""

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


@contextmanager
def local(workers: int, memory_limit: str | int = "auto") -> Iterator[Any]:
    """A client of so many worker processes on this machine, each with one thread."""
    with extra("fleet"):
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
    prologue = [*(dask.config.get("jobqueue.slurm.job-script-prologue", None) or []), "export RAYON_NUM_THREADS=1"]
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": DEATHS}),
        SLURMCluster(cores=1, processes=1, memory=memory, job_script_prologue=prologue, **options) as cluster,
        Client(cluster) as client,
    ):
        _check_job(cluster.job_script())
        cluster.adapt(minimum_jobs=workers, maximum_jobs=workers)
        yield client


def _check_job(script: str) -> None:
    """Refuses a job that Slurm would refuse: it would be submitted again and again."""
    tried = subprocess.run(["sbatch", "--test-only"], input=script, capture_output=True, text=True, check=False)
    if tried.returncode:
        raise Error(f"Slurm refuses the job: {tried.stderr.strip()}; check memory, walltime, partition and account")
