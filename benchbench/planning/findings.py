"""From what the certificate found to what the planner does next: margins, the error of the transcription taken off, a finer grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.check import Check
from benchbench.planning.case import Case
from benchbench.planning.margins import NONE, Margins, beyond, taken_back

CHEAP = {"rate_margin": 0.02, "contact_margin": 0.5}
"""Share of a limit up to which a margin is taken rather than a finer grid.

On `circle` 1 % of the arm's rate costs 1 to 2 ms of travel time, 1 % of the distance in contact 0.05 ms.
"""
EQUAL = {"rate_margin": 0.07, "contact_margin": 0.5}
"""The same where a finer grid has all intervals halved, which costs several times as much: 3 % of the arm's rate cost 0.19 % of travel time on `circle`."""
FREE = 1e-4
"""Share of the cost up to which a margin of a rate is taken, however large it is, up to `LARGEST`.

The arm swings on its way without anybody's asking; `random_hardware` seed 8 gives 9 % of its rate away for less than 1e-5.
"""
LARGEST = 0.25
"""Multipliers tell the price of small margins only."""
ALONG = 0.01
"""The same as `CHEAP` of a contact's condition that is kept along the path: 1 % of the speed of approach costs 9 ms there."""
AHEAD = 0.1
"""Largest margin of a contact that a finer grid starts with."""
RAISED = 2
"""How often margins are raised on one grid while there may be a finer one: what is exceeded even then comes back by less and less."""
HOPELESS = 1.5
"""Margin of a contact for which its intervals are cut even where the error of the transcription may be the reason."""


@dataclass(frozen=True)
class Round:
    """One round of the loop: the margins that its plan was made with, and what may be done on its grid.

    least       margins that any plan is made with
    most        largest margin beyond those
    may_refine  whether there may be a finer grid
    raised      how often margins were raised on this grid
    paths       the same of conditions that are kept along the path, by their names
    cheap       share of a limit up to which a margin is taken rather than a finer grid
    prices      share of the cost that a margin of all of a rate's limit takes, to first order; a rate that is not named has none
    correctable, corrected  whether the error of the transcription may be taken off its equations, and whether it was
    """

    margins: Margins
    least: Margins = field(default_factory=lambda: NONE)
    most: float = 0.5
    may_refine: bool = True
    raised: int = 0
    correctable: bool = False
    corrected: bool = False
    cheap: Mapping[str, float] = field(default_factory=lambda: CHEAP)
    prices: Mapping[str, float] = field(default_factory=dict)
    paths: Mapping[str, float] = field(default_factory=dict)

    def bearable(self, rates: Mapping[str, float]) -> bool:
        """Whether these margins of rates cost less than a finer grid, and are no larger than any may be."""
        own = self.least["rate_margin"]
        added = {name: share - own.get(name, 0.0) for name, share in rates.items()}
        return all(
            share <= min(self.cheap["rate_margin"], self.most)
            or self._free(share, self.prices.get(name, np.inf))
            for name, share in added.items()
        )

    def dear(self, contacts: Mapping[str, float], along: frozenset[str]) -> frozenset[str]:
        """Names of conditions kept along the path whose margin costs more than a finer grid."""
        added = {n: contacts.get(n, 0.0) - self.least["contact_margin"].get(n, 0.0) for n in along}
        return frozenset(
            n
            for n, share in added.items()
            if share > ALONG and not self._free(share, self.paths.get(n, np.inf))
        )

    def _free(self, share: float, price: float) -> bool:
        return share <= min(LARGEST, self.most) and share * price <= FREE


@dataclass(frozen=True)
class Step:
    """What to do next: solve with these margins, on a finer grid or on the same.

    correct   take the error of the transcription off its equations
    finer     cut intervals: without `correct` those with errors
    contacts  cut those in contact, too
    rates     with `correct`: cut those in which rates or the room are exceeded
    """

    margins: Margins
    finer: bool = False
    correct: bool = False
    rates: bool = False
    contacts: bool = False


def next_step(found: Certificate, case: Case, now: Round, apart: Certificate | None = None) -> Step | None:
    """Return what may cure all that the certificate found; None where nothing will.

    Margins of up to `CHEAP` are taken where margins alone cure it: the transcription of the planned flight is right, its
    limits are passed between the nodes. For errors of the transcription they are taken off its equations where that can be,
    and intervals are cut only where limits are passed between nodes by more than a cheap margin; else the grid is refined
    where the errors are. Where there may be no finer grid margins of up to `most` are taken.

    apart: the same with the flight of each interval from its planned state, see `mesh.apart`: what is exceeded there is exceeded between
    nodes, the rest has added up and goes with the errors.
    """
    raised = taken_back(now.margins, found, case)
    by_margins = raised != now.margins and beyond(raised, now.least) <= now.most
    curable = by_margins and all(_by_margin(check) for check in found.broken)
    along = _along(case)
    if curable and (not now.may_refine or (now.raised < RAISED and _cheap(raised, now, along))):
        return Step(raised, correct=now.corrected)
    if now.correctable:
        raised["rate_margin"] = taken_back(now.margins, apart or found, case)["rate_margin"]
        return _corrected(found, raised, now, along)
    if not now.may_refine:
        return None
    return Step(_ahead(raised, now.least, now.most), finer=True, contacts=_bent(found, now))


def _corrected(found: Certificate, raised: Margins, now: Round, along: frozenset[str]) -> Step | None:
    """Take the error of the transcription off, cut what margins do not cure, and take the margins that are cheap."""
    rates, contacts = raised["rate_margin"], dict(raised["contact_margin"])
    own = now.least["contact_margin"]
    dear = now.dear(contacts, along) if now.may_refine else frozenset()
    contacts |= {name: now.margins["contact_margin"].get(name, 0.0) for name in dear}
    most = {kind: min(share, now.most) if now.may_refine else now.most for kind, share in now.cheap.items()}
    fast = not now.bearable(rates) if now.may_refine else beyond({"rate_margin": rates}, now.least) > now.most
    bearable = most["contact_margin"] if now.corrected else HOPELESS
    near = max((m - own.get(n, 0.0) for n, m in contacts.items()), default=0.0) > bearable
    near |= _bent(found, now)
    room = any(check.name in ("replay_position", "replay_angle") for check in found.broken)
    if near:
        contacts = _ahead({**raised, "contact_margin": contacts}, now.least, now.most)["contact_margin"]
    margins = {
        "rate_margin": now.margins["rate_margin"] if fast else rates,
        "contact_margin": {
            n: max(min(m, own.get(n, 0.0) + most["contact_margin"]), own.get(n, 0.0))
            for n, m in contacts.items()
        },
    }
    if not now.may_refine and now.corrected and margins == now.margins:
        return None
    return Step(margins, now.may_refine, True, rates=fast or room or bool(dear), contacts=near)


def _bent(found: Certificate, now: Round) -> bool:
    """Whether a contact is still broken after margins were raised: in between its nodes, where margins do not reach."""
    return now.raised >= RAISED and any(check.name.startswith("contact_") for check in found.broken)


def _ahead(raised: Margins, least: Margins, most: float) -> Margins:
    """Margins for a finer grid: of contacts a quarter of what this one asks for, which costs less than another round."""
    own = least["contact_margin"]
    eased = {name: min(share / 4, AHEAD, most) for name, share in raised["contact_margin"].items()}
    eased = {name: share for name, share in eased.items() if share > own.get(name, 0.0)}
    return {"rate_margin": least["rate_margin"], "contact_margin": {**own, **eased}}


def _along(case: Case) -> frozenset[str]:
    """Names of conditions of contacts that are kept along the path."""
    stops = case.scenario.itinerary.stops
    return frozenset(n for stop in stops for n, c in stop.contacts.items() if c.kept != "in contact")


def _cheap(margins: Margins, now: Round, along: frozenset[str]) -> bool:
    own = now.least["contact_margin"]
    contacts = margins["contact_margin"]
    return (
        now.bearable(margins["rate_margin"])
        and not now.dear(contacts, along)
        and all(share - own.get(n, 0.0) <= now.cheap["contact_margin"] for n, share in contacts.items())
    )


def _by_margin(check: Check) -> bool:
    return check.name == "replay_rate" or check.name.startswith(("contact_", "replay_path_"))
