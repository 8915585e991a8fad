"""The loop from the certificate back to the planner: solve, fly, do what the findings ask for."""

from __future__ import annotations

from dataclasses import dataclass, field

from benchbench.certificate.certificate import Certificate
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.findings import Step, next_step
from benchbench.planning.ladder import climb, on_grid, rung
from benchbench.planning.margins import NONE, with_margins
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge

ROUNDS = 8
"""Solves that may follow the first one from a start."""


@dataclass
class Loop:
    """Rounds from any number of starts, on grids of at most `finest` intervals, with margins of at most `margin`.

    told: what each round gave, in words; tried: each result that claims success, with its certificate.
    """

    case: Case
    ledger: Ledger
    finest: int
    margin: float
    told: list[str] = field(default_factory=list)
    tried: list[tuple[Result, Certificate | None]] = field(default_factory=list)

    @property
    def best(self) -> Result:
        """The first certified result, else the one that breaks the fewest limits, else the last that was tried."""
        return min(self.tried, key=lambda one: (not one[0].claimed, _broken(one[1])))[0]

    def round(self, case: Case, start: Plan) -> bool:
        """Plan from one start until the certificate accepts; returns whether it does."""
        level = with_margins(case, NONE)
        found, step = climb(level, self.ledger, start), Step(1, NONE, "")
        for _ in range(ROUNDS):
            certificate = judge(found, self.case, self.ledger) if found.claimed else None
            self.tried.append((found, certificate))
            self.told.append(_sentence(level, found, certificate, step))
            if certificate is None or certificate.certified or self.ledger.over:
                break
            following = next_step(certificate, level, step.margins, self.margin, self.finest)
            if following is None:
                break
            step = following
            level = with_margins(on_grid(level, step.finer * level.scenario.grid_intervals), step.margins)
            found = rung(level, self.ledger, found.plan, found)
        return certificate is not None and certificate.certified


def _broken(certificate: Certificate | None) -> int:
    return len(certificate.broken) if certificate else 10**6


def _sentence(level: Case, found: Result, certificate: Certificate | None, step: Step) -> str:
    given = {**step.margins["rate_margin"], **step.margins["contact_margin"]}
    margins = ", ".join(f"{name} {share:.2%}" for name, share in given.items())
    at = f"N = {level.scenario.grid_intervals}" + (f", margins {margins}" if margins else "")
    if certificate is None:
        return f"{at}: {found.solved.outcome.claim}"
    verdict = "certified" if certificate.certified else certificate.reasons[0]
    return f"{at}: {found.plan.travel_time:.4f} s, {verdict}"
