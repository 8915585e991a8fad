"""`benchbench certify PLAN [OVERRIDE ...]`: judge a plan that anybody made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput

EPILOG = """The plan is flown again and judged like our own, and recorded with its picture. The exit code is 0 when it is
certified, 1 when not, 2 for bad input. The columns of the file stand in docs/foreign_plans.md.

examples
  benchbench certify plan.csv --scenario race scenario.gates=3 --name my_planner
  benchbench certify plan.csv --scenario circle scenario.kappa_init=5
  benchbench certify togt.csv --scenario race --motors agilicious vehicle.lever=0.1061
"""


def run(arguments: Sequence[str]) -> int | list[str]:
    """Return what it is short for; raises BadInput."""
    from benchbench.run.overrides import quoted

    asked, overrides = parser().parse_known_args(arguments)
    if asked.plan is None:
        raise BadInput("plan", "none was given", "the path of a CSV file, or of a plan.mcap")
    if not Path(asked.plan).is_file():
        raise BadInput(asked.plan, "there is no such file", "a CSV file with a plan")
    given = any(o.startswith("+scenario=") for o in overrides)
    if (asked.scenario is None) is not given:
        problem = "is chosen twice" if given else "none was chosen"
        raise BadInput("--scenario", problem, "--scenario NAME")
    scenario = [] if given else [f"+scenario={asked.scenario}"]
    form = [f"strategy.interpolation={asked.interpolation}"]
    if asked.motors:
        numbers = asked.motors.split(",")
        form.append(f"strategy.motors={asked.motors if len(numbers) == 1 else f'[{asked.motors}]'}")
    file, name = (quoted(text) for text in (asked.plan, asked.name))
    return [
        *scenario,
        *overrides,
        "strategy=foreign",
        f"strategy.file={file}",
        f"strategy.planner={name}",
        *form,
    ]


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("certify", "Judge a plan from a file by our certificate.", EPILOG, overrides=True)
    takes.add_argument(
        "plan", nargs="?", metavar="PLAN.csv", help="the plan: CSV, a plan.mcap, or an exported ROS 2 file"
    )
    takes.add_argument("--scenario", metavar="NAME", help="the task it is for")
    takes.add_argument(
        "--name", default="foreign", help="who made it, as the solver of the record (default: foreign)"
    )
    takes.add_argument(
        "--motors",
        metavar="ORDER",
        help="how the file numbers the motors: a convention (cpc, agilicious, px4), or for each of ours its number there, "
        "such as 4,1,3,2; docs/foreign_plans.md has a picture",
    )
    takes.add_argument(
        "--interpolation",
        choices=["hold", "linear"],
        default="hold",
        help="of the inputs: those of a row until the next (default), or from row to row; frames and recordings say it themselves",
    )
    return takes  # fmt: skip
