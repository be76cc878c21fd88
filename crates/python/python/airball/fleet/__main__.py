"""`python -m airball.fleet LOG… --config rig.toml --out reports --local 4`."""

import argparse
import sys
from contextlib import contextmanager

from ..errors import Error
from . import diagnose, local


@contextmanager
def _client(args: argparse.Namespace):  # type: ignore[no-untyped-def]
    if args.local is not None:
        with local(args.local) as client:
            yield client
        return
    from distributed import Client

    with Client(args.scheduler) as client:
        yield client


def main() -> int:
    """Reads the flags and runs."""
    parser = argparse.ArgumentParser("python -m airball.fleet", description="Diagnose each log by itself on the workers of Dask.")
    parser.add_argument("logs", nargs="+", metavar="LOG", help="a log, or a folder of logs, which the workers can read")
    parser.add_argument("--config", default="config.toml", metavar="FILE", help="config with the belief")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of the reports")
    parser.add_argument("--without", action="append", default=[], metavar="EFFECT", help="leave this effect out; may be repeated")
    parser.add_argument("--without-formula", action="store_true", help="search for no formula of what no effect explains")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", metavar="URL", help="address of a Dask scheduler, as tcp://host:8786")
    where.add_argument("--local", type=int, metavar="N", help="start N worker processes on this machine")
    args = parser.parse_args()
    try:
        with _client(args) as client:
            flags = {"without": args.without, "without_formula": args.without_formula}
            made = diagnose(args.logs, model=args.config, out=args.out, client=client, **flags)
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(f"{made.diagnosed} logs are diagnosed, {made.failed} cannot be read or diagnosed; page {made.out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
