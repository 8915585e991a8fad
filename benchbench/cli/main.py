"""The program: `python -m benchbench +scenario=circle solver=ipopt`; exit code 0 certified, 1 not, 2 bad input."""

from __future__ import annotations

import os
import sys

from benchbench.cli import interrupt

BROKEN_PIPE = 141
"""What a shell reports for a program whose reader went away, as in `benchbench ... | head`."""


def main() -> None:
    """Entry point of the console script and of `python -m benchbench`; never returns, exits with a code."""
    interrupt.take_over()
    try:
        if "_ARGCOMPLETE" in os.environ:
            from benchbench.cli.completion import complete

            complete()  # never returns
        from benchbench.cli import at_once  # imports next to nothing; Ctrl-C is heard by now

        asked = at_once.meant(sys.argv[1:])
        code = at_once.answer(asked)
        if code is None:
            from benchbench.cli.application import start  # imports everything

            code = start(asked)
        if interrupt.heard():
            interrupt.leave()
        sys.stdout.flush()
    except KeyboardInterrupt:
        interrupt.leave()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for Python's own flush at exit
        code = BROKEN_PIPE
    raise SystemExit(code)
