"""`benchbench robust [OVERRIDE ...]`: the fastest plan that succeeds in flight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser

if TYPE_CHECKING:
    from benchbench.cli.commands import Sweep

EPILOG = """Short for a sweep (-m) over gentler and faster plans of one task, each certified and then flown in the same worlds until its
success is proved or cannot be proved any more; it goes on where it stopped. At its end it names the fastest plan whose flights
prove the success that was asked for (exact, one-sided, 95 % confidence), and writes the front of travel time against success as
table and picture. It begins with three slopes of the approach and two aims, and goes on for at most three rounds with slopes between those
where success falls, and gentler ones where none proves it; what a plan beats that was flown is not tried. Values of any field that
are given as a list are searched instead, and nothing beside them.

examples
  benchbench robust +scenario=circle residual=observer mismatch=lab
  benchbench robust +scenario=static residual=gp_observer target_success=0.9 flights=100
  benchbench robust +scenario=circle scenario.contacts.approach.slope=4,8,16 scenario.authority=0,0.05
"""
GENTLE = "+scenario/contact=approach"
FIELD = "scenario.contacts.approach.slope"
AXES = {FIELD: "5,7,12", "scenario.aim.position": "0.6,1.0"}
"""What is searched where nothing else is: how fast the ball is neared, and how near to it the plan aims.

A plan comes within the magnet's reach of 22 mm at sqrt(0.05^2 + (0.022 slope)^2) m/s, and the judge allows 0.15: a slope of 6.4. So 5
leaves the controller 0.03 m/s, 7 is a little too fast, and 12 hardly asks for anything.
"""
DEFAULTS = {"flights": "124", "target_success": "0.95", "residual": "observer"}
"""124 flights prove 95 % with two failures, 93 with one, 59 with none."""


def run(arguments: Sequence[str]) -> Sweep:
    """Return the sweep it is short for; raises BadInput."""
    from benchbench.cli.commands import Sweep
    from benchbench.cli.robust_summary import conclude
    from benchbench.ground.errors import BadInput
    from benchbench.run.overrides import keys

    _, more = parser().parse_known_args(arguments)
    typed = [text for text in more if not text.startswith("-")]
    options = [text for text in more if text.startswith("-") and text not in ("-m", "--multirun")]
    asked = keys(typed)
    if "scenario" not in asked:
        raise BadInput("scenario", "none was chosen", "+scenario=NAME of a handover with one target")
    _check_target(typed)
    _check_count(typed)
    _check_flown(typed)
    added = [] if "scenario/contact" in asked else [GENTLE]
    added += [f"{key}={value}" for key, value in DEFAULTS.items() if key not in asked]
    if not any("," in text or "range(" in text or "choice(" in text for text in typed):
        added += [f"{key}={values}" for key, values in AXES.items() if key not in asked]
        added += _refining(typed) if not asked & {FIELD, "hydra/sweeper"} else []
    return Sweep(["-m", *options, *typed, *added], conclude)


def _refining(typed: Sequence[str]) -> list[str]:
    """The sweeper that goes on between the slopes, and what it has to prove."""
    told = [text.partition("=")[2] for text in typed if text.lstrip("+").startswith("target_success=")]
    target = told[-1] if told else DEFAULTS["target_success"]
    return ["hydra/sweeper=front", f"hydra.sweeper.field={FIELD}", f"hydra.sweeper.target={target}"]


def _check_target(typed: Sequence[str]) -> None:
    """Refuse once what every run of the search would refuse."""
    from benchbench.ground.errors import BadInput

    for text in typed:
        key, _, value = text.lstrip("+").partition("=")
        if key != "target_success":
            continue
        try:
            fits = 0 < float(value) < 1
        except ValueError:
            fits = False
        if not fits:
            raise BadInput(key, f"'{value}' was given", "a number above 0 and below 1")


def _check_count(typed: Sequence[str]) -> None:
    """Refuse once what plans only, or every run would refuse; lists of numbers are told by their runs."""
    from benchbench.ground.errors import BadInput

    for text in typed:
        key, _, value = text.lstrip("+").partition("=")
        if key == "flights" and "," not in value and not (value.isdecimal() and int(value) > 0):
            raise BadInput(
                key, f"'{value}' was given", "a whole number of at least 1: success is told of flights"
            )


def _check_flown(typed: Sequence[str]) -> None:
    """Refuse a scenario of ours that has nothing to be flown, before fields are added that it does not have."""
    from benchbench.flight.errand import errand
    from benchbench.ground.errors import BadInput, BenchBenchError
    from benchbench.run import config

    told = [text.partition("=")[2] for text in typed if text.lstrip("+").startswith("scenario=")]
    for name in ",".join(told).split(","):
        if name not in config.choices("scenario"):
            continue
        cfg, _ = config.composed(f"+scenario={name}")
        try:
            values = config.make(cfg, "scenario")
            scenario = config.scenario_of(values) if isinstance(values, dict) else values
        except BenchBenchError:  # something has to be said besides, which the runs are told
            continue
        try:
            errand(scenario)
        except BadInput as error:
            raise BadInput(
                "scenario", error.problem, "+scenario=NAME of a handover with one target"
            ) from None


def parser() -> Parser:
    """Return the arguments it takes."""
    return Parser("robust", "Find the fastest plan that succeeds as often as asked.", EPILOG, overrides=True)
