"""`benchbench plugins [FAMILY=NAME]`: what can be chosen, or the options of one choice."""

from __future__ import annotations

from collections.abc import Sequence

from benchbench.cli.listing import listing


def run(arguments: Sequence[str]) -> int:
    """Print the list; a solver that is not available here is told as such, it is no error."""
    for line in listing(arguments):
        print(line)
    return 0
