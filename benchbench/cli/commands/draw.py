"""`benchbench draw RUN ...`: pictures of stored plans."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.errors import BadInput

EPILOG = """A picture is the one that the run would have drawn, as far as today's program draws the same.

examples
  benchbench draw results/runs/DATE/TIME        one run, or its plan.mcap
  benchbench draw results/sweeps/DATE/TIME      all runs of a sweep that have none yet
"""


def run(arguments: Sequence[str]) -> int:
    """Draw, and print where the pictures are. Raises BadInput for what is no run with a plan."""
    from benchbench.run.redraw import draw_stored, redraw

    drawn: list[Path] = []
    for given in parser().parse_args(arguments).run:
        found = _runs(given)
        drawn += (
            [draw_stored(found[0])] if found == [_folder(given)] else [p for p in map(redraw, found) if p]
        )
    for path in drawn:
        print(path)
    print(f"{len(drawn)} picture{'' if len(drawn) == 1 else 's'} drawn")
    return 0


def _folder(given: Path) -> Path:
    return given.parent if given.is_file() else given


def _runs(given: Path) -> list[Path]:
    """The folder of a run, or all below a folder that is none."""
    from benchbench.storage.files import PLAN

    if (_folder(given) / PLAN).is_file():
        return [_folder(given)]
    found = sorted(path.parent for path in given.rglob(PLAN)) if given.is_dir() else []
    if not found:
        raise BadInput(
            str(given),
            "holds no plan" if given.is_dir() else "does not exist",
            f"a run's folder or its {PLAN}, or a folder of runs",
        )
    return found


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("draw", "Draw plan.png of stored runs.", EPILOG)
    takes.add_argument(
        "run",
        type=Path,
        nargs="+",
        metavar="RUN",
        help="a run's folder or its plan.mcap, or a folder of runs",
    )
    return takes
