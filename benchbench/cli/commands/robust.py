"""`benchbench robust [OVERRIDE ...]`: the fastest plan that succeeds in flight."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser

if TYPE_CHECKING:
    from benchbench.cli.commands import Sweep

EPILOG = """Short for a sweep (-m) over gentler and faster plans of one task, each certified and then flown in the same worlds until its
success is proved or cannot be proved any more; it goes on where it stopped. At its end it names the fastest plan whose flights
prove the success that was asked for (exact, one-sided, 95 % confidence), and writes the front of travel time against success as
table and picture. It begins with three slopes of the approach and two aims, and goes on in rounds with slopes between those where success
falls, and gentler ones where none proves it; what a plan beats that was flown is not tried. The fastest plan that proves it was lucky in its
worlds, too, so it is flown again in others (the next seed), and the search goes on where it does not prove it there. Values of any field that
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
    from benchbench.cli.robust_checks import HANDOVER, check_first, check_numbers, check_scenario, parsed
    from benchbench.cli.robust_summary import conclude
    from benchbench.ground.errors import BadInput
    from benchbench.run.overrides import keys

    _, more = parser().parse_known_args(arguments)
    typed = [text for text in more if not text.startswith("-")]
    options = [text for text in more if text.startswith("-") and text not in ("-m", "--multirun")]
    asked = keys(typed)
    if "scenario" not in asked:
        raise BadInput("scenario", "none was chosen", HANDOVER)
    check_numbers(typed)
    check_scenario(typed)
    added = [] if "scenario/contact" in asked else [GENTLE]
    added += [f"{key}={value}" for key, value in DEFAULTS.items() if key not in asked]
    if not any(one.is_sweep_override() for one in parsed(typed)):
        added += [f"{key}={values}" for key, values in AXES.items() if key not in asked]
        added += _refining(typed) if not asked & {FIELD, "hydra/sweeper"} else []
    if not options:  # which may name folders of configuration
        check_first([*typed, *added])
    return Sweep(
        ["-m", *options, *typed, *added], partial(conclude, "hydra/sweeper=front" in (*typed, *added))
    )


def _refining(typed: Sequence[str]) -> list[str]:
    """The sweeper that goes on between the slopes, and what it has to prove."""
    told = [text.partition("=")[2] for text in typed if text.lstrip("+").startswith("target_success=")]
    target = told[-1] if told else DEFAULTS["target_success"]
    return ["hydra/sweeper=front", f"hydra.sweeper.field={FIELD}", f"hydra.sweeper.target={target}"]


def parser() -> Parser:
    """Return the arguments it takes."""
    return Parser("robust", "Find the fastest plan that succeeds as often as asked.", EPILOG, overrides=True)
