"""From what the certificate found to what the planner does next: margins, a finer grid, or nothing that would help."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.check import Check
from benchbench.planning.case import Case
from benchbench.planning.margins import Margins, largest, taken_back

CHEAP = {"rate_margin": 0.05, "contact_margin": 0.5}
"""Share of a limit up to which a margin is taken rather than a finer grid.

On `circle` 1 % of the arm's rate costs 1 to 2 ms of travel time, 1 % of the distance in contact 0.05 ms.
"""
FAR = 3.5
"""Where a limit is passed by more than this factor the next grid has four times the intervals, else twice."""


@dataclass(frozen=True)
class Step:
    """What to do next: solve on `finer` times as many intervals, with `margins`. why: what asks for it, in words."""

    finer: int
    margins: Margins
    why: str


def next_step(found: Certificate, case: Case, margins: Margins, most: float, finest: int) -> Step | None:
    """Return what may cure all that the certificate found; None where nothing will.

    Margins of up to `CHEAP` are taken where margins alone cure it: the transcription of the planned flight is right, its
    limits are passed between the nodes. Errors of the transcription and larger margins ask for a finer grid, up to
    `finest` intervals in all, and beyond it for margins of up to `most`.
    """
    why = found.broken[0].name if len(found.broken) == 1 else f"{found.broken[0].name} and others"
    raised = taken_back(margins, found, case)
    curable = raised != margins and all(_by_margin(check) for check in found.broken)
    if curable and largest(raised) <= most and _cheap(raised):
        return Step(1, raised, why)
    intervals = case.scenario.grid_intervals
    for factor in (4, 2) if _far(found) else (2,):
        if factor * intervals <= finest:
            return Step(factor, margins, why)
    return Step(1, raised, why) if curable and largest(raised) <= most else None


def _cheap(margins: Margins) -> bool:
    return all(share <= CHEAP[kind] for kind, own in margins.items() for share in own.values())


def _by_margin(check: Check) -> bool:
    return check.name == "replay_rate" or check.name.startswith("contact_")


def _far(found: Certificate) -> bool:
    """Whether an error of second order needs more than twice the intervals."""
    ratios = [
        check.value / check.limit for check in found.broken if check.limit > 0 and check.name != "replay_end"
    ]
    return sqrt(max(ratios, default=1.0)) > sqrt(FAR)
