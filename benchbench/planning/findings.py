"""From what the certificate found to what the planner does next: margins, a finer grid, or nothing that would help."""

from __future__ import annotations

from dataclasses import dataclass

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.check import Check
from benchbench.planning.case import Case
from benchbench.planning.margins import NONE, Margins, largest, taken_back

CHEAP = {"rate_margin": 0.05, "contact_margin": 0.5}
"""Share of a limit up to which a margin is taken rather than a finer grid.

On `circle` 1 % of the arm's rate costs 1 to 2 ms of travel time, 1 % of the distance in contact 0.05 ms.
"""
AHEAD = 0.1
"""Largest margin of a contact that a finer grid starts with."""


@dataclass(frozen=True)
class Step:
    """What to do next: solve on a finer grid, or on the same one with these margins."""

    finer: bool
    margins: Margins


def next_step(
    found: Certificate,
    case: Case,
    margins: Margins,
    most: float,
    may_refine: bool,
    least: Margins = NONE,
    patient: bool = True,
) -> Step | None:
    """Return what may cure all that the certificate found; None where nothing will.

    Margins of up to `CHEAP` are taken where margins alone cure it: the transcription of the planned flight is right, its
    limits are passed between the nodes. Errors of the transcription and larger margins ask for a finer grid, and where
    there may be none for margins of up to `most`.

    margins: those that the plan was made with; least: those that any plan is made with; patient: whether margins may be
    raised on this grid once more.
    """
    raised = taken_back(margins, found, case)
    curable = (
        raised != margins and largest(raised) <= most and all(_by_margin(check) for check in found.broken)
    )
    if curable and ((patient and _cheap(raised)) or not may_refine):
        return Step(False, raised)
    return Step(True, _ahead(raised, least, most)) if may_refine else None


def _ahead(raised: Margins, least: Margins, most: float) -> Margins:
    """Margins for a finer grid: of contacts a quarter of what this one asks for, which costs less than another round."""
    own = least["contact_margin"]
    eased = {name: min(share / 4, AHEAD, most) for name, share in raised["contact_margin"].items()}
    eased = {name: share for name, share in eased.items() if share > own.get(name, 0.0)}
    return {"rate_margin": least["rate_margin"], "contact_margin": {**own, **eased}}


def _cheap(margins: Margins) -> bool:
    return all(share <= CHEAP[kind] for kind, own in margins.items() for share in own.values())


def _by_margin(check: Check) -> bool:
    return check.name == "replay_rate" or check.name.startswith(("contact_", "replay_path_"))
