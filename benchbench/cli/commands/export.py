"""`benchbench export PLAN --output FILE`: a plan to fly: CSV, ROS 2 messages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput

SUFFIXES = {".csv": "csv", ".mcap": "ros2"}

EXAMPLES = """examples
  benchbench export results/runs/DATE/TIME --output plan.csv
  benchbench export results/runs/DATE/TIME/plan.mcap --output flight.mcap      ROS 2 messages
"""


def run(arguments: Sequence[str]) -> int:
    """Write the file and say what is in it; raises BadInput."""
    from benchbench.storage import flight_csv, ros2
    from benchbench.storage.files import write_bytes
    from benchbench.storage.multirotor import trajectory_of
    from benchbench.storage.playback import read_mcap

    asked = parser().parse_args(arguments)
    path = _recording(asked.plan)
    kind = asked.format or SUFFIXES.get(asked.output.suffix)
    if kind is None:
        raise BadInput("--output", f"cannot tell the format of '{asked.output.name}'", "--format csv or ros2")
    if asked.output.resolve() == path.resolve():
        raise BadInput("--output", f"'{asked.output}' is the plan itself", "another file")
    try:
        recording = read_mcap(path)
    except (OSError, ValueError) as error:
        raise BadInput(
            str(path), f"is no plan that can be read: {error}", "a plan.mcap that a run wrote"
        ) from None
    flight = trajectory_of(recording.plan)
    if kind == "csv":
        data = flight_csv.to_csv(flight).encode()
    else:
        data = ros2.to_mcap(flight, {"config": recording.config})
    write_bytes(asked.output, data)
    arm = "" if flight.arm is None else " with its arm"
    print(f"{len(flight.time)} points, {recording.plan.travel_time:.4f} s{arm} in {asked.output}")
    if recording.plan.interpolation == "bezier":
        print(
            "the inputs of this plan are polynomials between its points; the file has their values at the points"
        )
    return 0


def _recording(given: Path) -> Path:
    from benchbench.storage.files import PLAN

    path = given / PLAN if given.is_dir() else given
    if not path.is_file():
        raise BadInput(
            str(given), "has no plan" if given.is_dir() else "does not exist", f"a run's folder or its {PLAN}"
        )
    return path


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "export",
        "Write a plan as CSV or as ROS 2 messages in MCAP; docs/export.md says what is in them.",
        EXAMPLES,
    )
    takes.add_argument("plan", type=Path, metavar="PLAN", help="a run's folder or its plan.mcap")
    takes.add_argument(
        "--format",
        choices=sorted(SUFFIXES.values()),
        help="default: csv for a name in .csv, ros2 for one in .mcap",
    )
    takes.add_argument("--output", type=Path, required=True, metavar="FILE", help="file to write")
    return takes
