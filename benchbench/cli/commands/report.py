"""`benchbench report DIR ...`: all runs as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput, Unavailable
from benchbench.run.telling import complain

if TYPE_CHECKING:
    from argparse import Namespace

    from benchbench.cli.gathering import Gathered
    from benchbench.run.working import Working

PLANS, ROWS = 12, 1000

EXAMPLES = """examples
  benchbench report results                                     report.html
  benchbench report results other --output both.html --title "Two machines"
  benchbench report results --plans 0                           tables and charts only
  benchbench report laptop.zip server.zip                       bundles; their plans are certified anew
  benchbench report laptop.zip results --leaderboard            leaderboard.html and the folder of its plans
"""


def run(arguments: Sequence[str]) -> int:
    """Write the report and say where it is; raises BadInput."""
    asked = parser().parse_args(arguments)
    for name in ("plans", "rows"):
        if getattr(asked, name) < 0:
            raise BadInput(f"--{name}", f"{getattr(asked, name)} was given", "a number of at least 0")
    if asked.leaderboard and asked.as_recorded:
        raise BadInput("--as-recorded", "a leaderboard believes no record", "the one or the other")
    from benchbench.cli.gathering import gathered
    from benchbench.run.working import Working

    output = asked.output or Path("leaderboard.html" if asked.leaderboard else "report.html")
    with (
        Working("reading runs") as hear,
        gathered(asked.folders, hear, everything=asked.leaderboard, trust=asked.as_recorded) as found,
    ):
        try:
            told = (_leaderboard if asked.leaderboard else _report)(found, asked, output, hear)
        except ModuleNotFoundError as error:
            raise Unavailable(
                f"report: {error.name} is not installed; pip install 'benchbench[report]'"
            ) from None
    for path, problem in found.problems.items():
        complain("left out", f"{path}: {problem}")
    if found.said:
        complain("bundles" if not asked.leaderboard else "leaderboard", found.said)
    print(f"{told} in {output} ({output.stat().st_size / 1e6:.1f} MB)")
    return 0


def _report(found: Gathered, asked: Namespace, output: Path, hear: Working) -> str:
    from benchbench.cli.report_content import content
    from benchbench.report.html.page import render
    from benchbench.storage.files import write_bytes

    report = content(found, asked.folders, asked.title, asked.plans, asked.rows, hear)
    hear("writing the page")
    write_bytes(output, render(report).encode())
    return f"{len(report.runs)} runs, {len(report.plans)} plans"


def _leaderboard(found: Gathered, asked: Namespace, output: Path, hear: Working) -> str:
    from benchbench.cli.leaderboard_content import board
    from benchbench.report.html.leaderboard import render
    from benchbench.storage.files import write_bytes

    plans = output.with_name(f"{output.stem}_plans")
    made = board(found, asked.title, asked.plans, plans, output, hear)
    write_bytes(output, render(made).encode())
    return f"{len(made.rows)} methods, {len(made.tasks)} tasks, {len(made.entries)} plans"


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "report", "Write one HTML file about all runs below the folders; it needs no network.", EXAMPLES
    )
    takes.add_argument(
        "folders", nargs="+", type=Path, metavar="DIR", help="folders with results, or bundles"
    )
    takes.add_argument(
        "--output", type=Path, metavar="FILE", help="default: report.html, or leaderboard.html"
    )
    takes.add_argument(
        "--leaderboard",
        action="store_true",
        help="methods against tasks; only plans that are certified anew count, each with its command",
    )
    takes.add_argument(
        "--as-recorded",
        action="store_true",
        help="take the word of bundles: certify none of their plans anew",
    )
    takes.add_argument(
        "--plans",
        type=int,
        default=PLANS,
        metavar="N",
        help=f"largest number of plans that are shown, best first (default: {PLANS})",
    )
    takes.add_argument(
        "--rows",
        type=int,
        default=ROWS,
        metavar="N",
        help=f"largest number of runs in the list (default: {ROWS})",
    )
    takes.add_argument("--title", help="default: the names of the folders")
    return takes  # fmt: skip
