"""`benchbench plugins [FAMILY=NAME]`: what there is, and whether it works."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from benchbench.cli.arguments import Parser
from benchbench.run.fitting import fitted

EPILOG = """Solvers are tried in processes of their own, so that one which crashes, or has no licence, is told as such. What
was found is remembered until Python, an installed distribution, a plugin, a library or a licence changes.

examples
  benchbench plugins                    everything there is to choose from
  benchbench plugins --anew             try all of it again
  benchbench plugins solver=ipopt       its own options, for each accuracy
  benchbench plugins relaxation=paper   what it is
"""


REMEMBERED = "plugins"
COLUMNS = re.compile(r"  \S+ +\S+ +")
"""What stands in front of the text of a choice."""


def at_once(arguments: Sequence[str]) -> int | None:
    """Print the list where nothing has changed since it was made; None where it has to be made."""
    from benchbench.cli.remembered import recall

    if arguments or (lines := recall(REMEMBERED)) is None:
        return None
    _show(lines)
    return 0


def _show(lines: Iterable[str]) -> None:
    for line in lines:
        columns = COLUMNS.match(line)
        print(fitted(line, columns.end() if columns else 0))


def run(arguments: Sequence[str]) -> int:
    """Print the list; a solver that is not available here is told as such, it is no error. Raises BadInput."""
    from benchbench.cli.listing import listing
    from benchbench.cli.remembered import keep
    from benchbench.run.working import Working

    asked = parser().parse_args(arguments)
    with Working("trying every plugin; what is found is remembered") as hear:
        lines = [*listing([asked.choice] if asked.choice else [], hear)]
    _show(lines)
    if not asked.choice:
        keep(REMEMBERED, lines)
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
    takes.add_argument(
        "--anew", action="store_true", help="try everything anew, also where nothing seems to have changed"
    )
    return takes
