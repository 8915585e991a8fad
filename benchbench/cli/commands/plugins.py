"""`benchbench plugins [FAMILY=NAME]`: what there is, and whether it works."""

from __future__ import annotations

from collections.abc import Sequence

from benchbench.cli.arguments import Parser

EPILOG = """Solvers are tried in processes of their own, so that one which crashes, or has no licence, is told as such.

examples
  benchbench plugins                    everything there is to choose from
  benchbench plugins solver=ipopt       its own options, for each accuracy
  benchbench plugins relaxation=paper   what it is
"""


def run(arguments: Sequence[str]) -> int:
    """Print the list; a solver that is not available here is told as such, it is no error. Raises BadInput."""
    from benchbench.cli.listing import listing

    asked = parser().parse_args(arguments)
    for line in listing([asked.choice] if asked.choice else []):
        print(line)
    return 0


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "plugins",
        "Everything there is to choose from, whether it works here, and where it comes from.",
        EPILOG,
    )
    takes.add_argument(
        "choice", nargs="?", metavar="FAMILY=NAME", help="one choice: what it is, and its options"
    )
    return takes
