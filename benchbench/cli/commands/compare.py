"""`benchbench compare A B`: two runs, or two folders of runs, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput

EPILOG = """Of two runs it says what was chosen differently, what came out, and draws both plans into one figure. Of two folders it
pairs the runs by what both chose alike (task, seed, solver ...), the newest of each, and says what came out of each pair.

examples
  benchbench compare results/runs/DATE/TIME results/runs/DATE/OTHER
  benchbench compare RUN_ID OTHER_ID --output both.pdf        as benchbench runs lists them
  benchbench compare results_ipopt results_uno --output uno.png
"""


def run(arguments: Sequence[str]) -> int:
    """Print both sides and draw them; raises BadInput for what is no run and no folder of runs."""
    from benchbench.cli.comparison import compare_folders, compare_runs
    from benchbench.cli.finding import run_folder
    from benchbench.report.figure_file import STILL

    asked = parser().parse_args(arguments)
    if asked.output.suffix.lower() not in STILL:
        raise BadInput("--output", f"cannot tell the format of '{asked.output.name}'", ", ".join(STILL))
    sides = (asked.one, asked.other)
    folders = [given for given in sides if _is_of_many(given)]
    for given in sides:
        if given not in folders:
            run_folder(given)
    if len(folders) == 1:
        raise BadInput(
            folders[0], "holds runs, and the other side is one run", "two runs, or two folders of runs"
        )
    if folders:
        told = compare_folders(Path(asked.one), Path(asked.other), asked.output)
    else:
        told = compare_runs(asked.one, asked.other, asked.output)
    print(told)
    return 0


def _is_of_many(given: str) -> bool:
    """Whether it is a folder, but not that of a run."""
    from benchbench.storage.files import RECORD

    return Path(given).is_dir() and not (Path(given) / RECORD).is_file()


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("compare", "Two runs, or two folders of runs, side by side.", EPILOG)
    takes.add_argument("one", metavar="A", help="a run's folder or its run_id, or a folder of runs")
    takes.add_argument("other", metavar="B", help="the same of the other side")
    takes.add_argument(
        "--output",
        type=Path,
        default=Path("compare.png"),
        metavar="FILE",
        help="the figure: .png, .pdf or .svg (default: compare.png)",
    )
    return takes
