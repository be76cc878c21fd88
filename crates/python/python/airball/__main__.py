"""The command line: `airball …` and `python -m airball …`."""

import os
import signal
import sys

from airball import _airball


def run() -> None:
    """Runs the program and ends the process with its exit status."""
    # As in the binary: Ctrl-C ends a command that does not land a flight, and a closed pipe is the program's matter.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    status = _airball.main(sys.executable, sys.argv[1:])
    sys.stdout.flush()
    # At once: threads of a computation that is over are not waited for.
    os._exit(status)


if __name__ == "__main__":
    run()
