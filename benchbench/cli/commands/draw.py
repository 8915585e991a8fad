"""`benchbench draw RUN ...`: pictures of stored plans."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput

EPILOG = """A picture is the one that the run would have drawn, as far as today's program draws the same.

examples
  benchbench draw results/runs/DATE/TIME                       one run, or its plan.mcap: plan.png
  benchbench draw results/sweeps/DATE/TIME                     all runs of a sweep that have none yet
  benchbench draw results/runs/DATE/TIME --output plan.pdf     for a paper: .pdf, .svg, fonts embedded
  benchbench draw results/runs/DATE/TIME --output plan.gif     as it is flown: .gif, .mp4
  benchbench draw results/runs/DATE/TIME/flight.mcap           the flight that was recorded, as MuJoCo shows it: flight.mp4
"""
FLIGHT = "flight.mcap"


def run(arguments: Sequence[str]) -> int:
    """Draw, and print where the pictures are. Raises BadInput for what is no run with a plan."""
    from benchbench.run.redraw import draw_stored, redraw

    asked = parser().parse_args(arguments)
    _check(asked)
    if asked.run[0].name == FLIGHT:
        return _film(asked)
    drawn: list[Path] = []
    for given in asked.run:
        found = _runs(given)
        alone = found == [_folder(given)]
        if asked.output and not alone:
            raise BadInput("--output", "takes the plan of one run", "a run's folder, or no --output")
        drawn += (
            [draw_stored(found[0], asked.output, asked.fps)]
            if alone
            else [p for p in map(redraw, found) if p]
        )
    for path in drawn:
        print(path)
    print(f"{len(drawn)} picture{'' if len(drawn) == 1 else 's'} drawn")
    return 0


def _film(asked: Namespace) -> int:
    """The video of a flight that was recorded."""
    from benchbench.run.filming import film_flight

    if not asked.run[0].is_file():
        raise BadInput(str(asked.run[0]), "does not exist", f"the {FLIGHT} of a run")
    print(film_flight(asked.run[0], asked.output or asked.run[0].with_suffix(".mp4"), asked.fps))
    return 0


def _check(asked: Namespace) -> None:
    if asked.output and len(asked.run) > 1:
        raise BadInput("--output", f"{len(asked.run)} runs were given", "one run")
    if not 1 <= asked.fps <= 100:
        raise BadInput("--fps", f"{asked.fps:g} was given", "a number from 1 to 100")


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
    takes = Parser("draw", "Draw the plans of stored runs.", EPILOG)
    takes.add_argument(
        "run",
        type=Path,
        nargs="+",
        metavar="RUN",
        help="a run's folder or its plan.mcap, or a folder of runs",
    )
    takes.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="a file in .png, .pdf, .svg, .gif or .mp4 (default: plan.png of the run)",
    )
    takes.add_argument(
        "--fps", type=float, default=20.0, metavar="N", help="frames per second of a film (default: 20)"
    )
    return takes
