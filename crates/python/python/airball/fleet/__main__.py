"""`python -m airball.fleet LOG… --config rig.toml --out reports --local 4`, and `--across` to compare the rigs."""

import argparse
import sys
from typing import Any

from .._extras import extra
from ..errors import Error
from . import diagnose, local, slurm


def _client(args: argparse.Namespace) -> Any:
    """The client of the workers that the flags name, as a context."""
    if args.local is not None:
        return local(args.local)
    if args.slurm is not None:
        options = {name: getattr(args, name) for name in ("memory", "walltime") if getattr(args, name) is not None}
        return slurm(args.slurm, **options)
    with extra("fleet"):
        from distributed import Client
    try:
        return Client(args.scheduler)
    except (OSError, ValueError) as error:
        raise Error(f"cannot reach the scheduler {args.scheduler}: {error}; check its address, and that it runs") from error


def _count(word: str) -> int:
    count = int(word)
    if count < 1:
        raise argparse.ArgumentTypeError(f"{count} workers do nothing; give 1 or more")
    return count


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("python -m airball.fleet", description="Diagnose each log by itself on the workers of Dask.")
    parser.add_argument("logs", nargs="*", metavar="LOG", help="a log or a folder of logs that the workers can read: path, pattern or URL")
    parser.add_argument("--config", default="config.toml", metavar="FILE", help="config with the belief")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of the reports")
    parser.add_argument("--without", action="append", default=[], metavar="EFFECT", help="leave this effect out; may be repeated")
    parser.add_argument("--without-formula", action="store_true", help="search for no formula of what no effect explains")
    parser.add_argument("--across", action="store_true", help="compare the rigs, in class.html; without LOG, those in DIR already")
    parser.add_argument(
        "--rig", metavar="REGEX", help="for --across: the rig in a log's name, as the first group or whole match [its folder]"
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="URL", help="address of a Dask scheduler, as tcp://host:8786")
    where.add_argument("--local", type=_count, metavar="N", help="start N worker processes on this machine")
    where.add_argument("--slurm", type=_count, metavar="N", help="submit N jobs to Slurm, each a worker")
    parser.add_argument("--memory", metavar="SIZE", help="for --slurm: memory of a job [2GB]")
    parser.add_argument("--walltime", metavar="HH:MM:SS", help="for --slurm: time limit of a job [00:30:00]")
    return parser


def _checked(parser: argparse.ArgumentParser) -> argparse.Namespace:
    args = parser.parse_args()
    if not args.logs and not args.across:
        parser.error("give at least one LOG, or --across for the reports in --out")
    if args.logs and args.local is None and args.scheduler is None and args.slurm is None:
        parser.error("one of --scheduler, --local and --slurm is required for LOG")
    if args.slurm is None and (args.memory or args.walltime):
        parser.error("--memory and --walltime are for --slurm")
    if args.rig is not None and not args.across:
        parser.error("--rig is for --across")
    return args


def _diagnosed(args: argparse.Namespace) -> str:
    with _client(args) as client:
        flags = {"without": args.without, "without_formula": args.without_formula}
        made = diagnose(args.logs, model=args.config, out=args.out, client=client, **flags)
    counts = f"{made.diagnosed} logs are diagnosed, {made.cannot_answer} cannot answer, {made.failed} cannot be read or diagnosed"
    return f"{counts}; page {made.out / 'index.html'}"


def main() -> int:
    """Reads the flags and runs."""
    args = _checked(_parser())
    try:
        if args.logs:
            print(_diagnosed(args))
        if args.across:
            from . import across

            found = across(args.out, args.rig)
            print(f"{len(found.rigs)} rigs are compared, {len(found.outliers)} outliers; page {found.page}")
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
