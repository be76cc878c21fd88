"""Makes the diagnoses of a blind proof on the workers of Dask: those that `blind --plan` lists, for `blind --verdicts`.

python crates/score/blind_fleet.py PLAN --out VERDICTS --local 4
python crates/score/blind_fleet.py PLAN --out VERDICTS --scheduler tcp://head:8786

The workers read records by their paths, and must have the build of the package that this process has. A record that cannot
be diagnosed has no verdict, as on one machine; a diagnosis whose workers die again and again ends the proof.
"""

import argparse
import hashlib
import json
import os
import sys
from pathlib import Path

from distributed import Client

import airball as ab
from airball.fleet import local
from airball._files import write_whole
from airball.fleet._run import Task, results


def verdict(model, record, without):
    """What a worker does: the diagnosis as JSON, or the reason why there is none."""
    try:
        found = ab.diagnose(model, ab.read(record, model), without=without, progress=False)
        return found.json(), ""
    except ab.Error as error:
        return "", str(error)


def build():
    """The sha256 of the compiled part of the package in this process, where there is one."""
    try:
        from airball import _airball
    except ImportError:
        return "none"
    return hashlib.sha256(Path(_airball.__file__).read_bytes()).hexdigest()


def check_builds(client):
    """Refuses workers with another build: the page names one commit."""
    ours = build()
    for worker, theirs in client.run(build).items():
        if theirs != ours:
            raise ab.Error(
                f"the worker {worker} has another build of the package airball (sha256 {theirs[:12]}, here {ours[:12]}); "
                f"start it with PYTHONPATH={Path(ab.__file__).parents[1]}"
            )


def tasks(plan, out):
    """The planned diagnoses that are not there yet. A belief that cannot be read is said, and has no verdict."""
    for planned in map(json.loads, plan.read_text(encoding="utf-8").splitlines()):
        if (out / planned["verdict"]).exists():
            continue
        try:
            model = ab.Model.load(planned["belief"])
        except ab.Error as error:
            print(f"{planned['verdict']}: {error}", file=sys.stderr)
            continue
        yield Task(planned["verdict"], (model, os.path.abspath(planned["record"]), planned["without"]))


def make(client, plan, out):
    """Writes the verdicts."""
    check_builds(client)
    for name, made, lost in results(client, verdict, tasks(plan, out)):
        if lost:
            raise ab.Error(f"{lost}; the page would not be that of one machine")
        document, error = made
        if error:
            print(f"{name}: {error}", file=sys.stderr)
            continue
        path = out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, document + "\n")


def main():
    """Reads the flags and runs."""
    parser = argparse.ArgumentParser(description="Makes the diagnoses of a blind proof on the workers of Dask.")
    parser.add_argument("plan", type=Path, metavar="PLAN", help="what `blind --plan` printed")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the verdicts")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", metavar="URL", help="address of a Dask scheduler, as tcp://host:8786")
    where.add_argument("--local", type=int, metavar="N", help="start N worker processes on this machine")
    args = parser.parse_args()
    try:
        with Client(args.scheduler) if args.scheduler else local(args.local) as client:
            make(client, args.plan, args.out)
    except ab.Error as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
