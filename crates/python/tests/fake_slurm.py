"""A Slurm of three programs: a job is a process of this machine, in a group of its own."""

import os
import signal
import stat
import sys
from pathlib import Path

SBATCH = """#!/bin/sh
if [ "$1" = --test-only ]; then
    grep -q "^#SBATCH -p nowhere" || exit 0
    echo "sbatch: error: invalid partition specified: nowhere" >&2
    exit 1
fi
cd "$FAKE_SLURM"
id=$$
for script; do :; done
cp "$script" $id.job
setsid sh -c "exec bash $id.job" >$id.out 2>&1 </dev/null &
echo $! >$id.pid
echo "Submitted batch job $id"
"""
SCANCEL = """#!/bin/sh
cd "$FAKE_SLURM"
for id; do kill -9 -- "-$(cat $id.pid)" 2>/dev/null; echo $id >>cancelled; done
"""
SQUEUE = """#!/bin/sh
cd "$FAKE_SLURM"
for pid in *.pid; do kill -0 "$(cat $pid)" 2>/dev/null && echo "${pid%.pid}"; done
"""


class FakeSlurm:
    """The jobs of `sbatch`, `scancel` and `squeue` in a folder."""

    def __init__(self, folder: Path) -> None:
        self.jobs, self.bin = folder / "jobs", folder / "bin"
        self.jobs.mkdir()
        self.bin.mkdir()
        for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL), ("squeue", SQUEUE)):
            program = self.bin / name
            program.write_text(text)
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
        here = os.path.dirname(sys.executable)
        self.environment = {"PATH": f"{self.bin}:{here}:{os.environ['PATH']}", "FAKE_SLURM": str(self.jobs)}

    def submitted(self) -> list[str]:
        """The scripts of all jobs."""
        return [job.read_text() for job in sorted(self.jobs.glob("*.job"))]

    def running(self) -> list[int]:
        """The numbers of the jobs that have not ended."""
        return [int(pid.stem) for pid in sorted(self.jobs.glob("*.pid")) if _runs(int(pid.read_text()))]

    def kill(self, job: int) -> None:
        """Ends a job as its walltime does."""
        os.killpg(int((self.jobs / f"{job}.pid").read_text()), signal.SIGKILL)


def _runs(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"
