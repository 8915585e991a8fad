"""`benchbench report DIR ...`: all runs as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.errors import BadInput, Unavailable
from benchbench.run.telling import complain

PLANS, ROWS = 12, 1000

EXAMPLES = """examples
  benchbench report results                                     report.html
  benchbench report results other --output both.html --title "Two machines"
  benchbench report results --plans 0                           tables and charts only
"""


def run(arguments: Sequence[str]) -> int:
    """Write the report and say where it is; raises BadInput."""
    asked = parser().parse_args(arguments)
    for name in ("plans", "rows"):
        if getattr(asked, name) < 0:
            raise BadInput(f"--{name}", f"{getattr(asked, name)} was given", "a number of at least 0")
    from benchbench.storage.files import write_bytes

    try:
        from benchbench.cli.report_content import content
        from benchbench.report.html.page import render
    except ModuleNotFoundError as error:
        raise Unavailable(
            f"report: {error.name} is not installed; pip install 'benchbench[report]'"
        ) from None
    report = content(asked.folders, asked.title, asked.plans, asked.rows)
    for path, problem in report.problems.items():
        complain("left out", f"{path}: {problem}")
    write_bytes(asked.output, render(report).encode())
    size = asked.output.stat().st_size / 1e6
    print(f"{len(report.runs)} runs, {len(report.plans)} plans in {asked.output} ({size:.1f} MB)")
    return 0


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "report", "Write one HTML file about all runs below the folders; it needs no network.", EXAMPLES
    )
    takes.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="folders with results")
    takes.add_argument(
        "--output", type=Path, default=Path("report.html"), metavar="FILE", help="default: report.html"
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
