"""The loop from the certificate back to the planner: solve, fly, do what the findings ask for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from benchbench.certificate.certificate import Certificate
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.findings import next_step
from benchbench.planning.ladder import climb, on_grid, rung
from benchbench.planning.margins import NONE, Margins, own_margins, with_margins
from benchbench.planning.mesh import halved, marked, steady
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge

ROUNDS = 10
"""Solves that may follow the first one from a start."""

RAISED = 2
"""How often margins are raised on one grid while there may be a finer one: what is exceeded even then comes back by less and less."""

Refinement = Literal["local", "uniform"]


@dataclass
class Loop:
    """Rounds from any number of starts, with margins of at most `margin`; grids below `finest` intervals may be refined.

    margin      0: those of the scenario instead of measured ones
    refinement  where a grid is refined: in the intervals in which the replay found errors, or everywhere
    told        what each round gave, in words
    tried       each result, with its certificate where it claims success
    """

    case: Case
    ledger: Ledger
    finest: int
    margin: float
    refinement: Refinement = "local"
    told: list[str] = field(default_factory=list)
    tried: list[tuple[Result, Certificate | None]] = field(default_factory=list)

    @property
    def best(self) -> Result:
        """The first certified result, else the one that breaks the fewest limits, else the last that was tried."""
        best, _ = min(self.tried, key=lambda one: (not one[0].claimed, _broken(one[1])))
        return replace(best, refined=True)

    def certifies(self, case: Case, start: Plan) -> bool:
        """Plan from one start until the certificate accepts; returns whether it does."""
        least = NONE if self.margin else own_margins(case.scenario)
        level, margins = with_margins(case, least), least
        found, raised = climb(level, self.ledger, start), 0
        for left in reversed(range(ROUNDS + 1)):
            certificate = judge(found, self.case, self.ledger) if found.claimed else None
            self.tried.append((found, certificate))
            self.told.append(_sentence(found, certificate, margins))
            if certificate is None or certificate.certified or self.ledger.over or not left:
                break
            may_refine, patient = found.plan.intervals < self.finest, raised < RAISED
            step = next_step(certificate, level, margins, self.margin, may_refine, least, patient)
            if step is None:
                break
            raised = 0 if step.finer else raised + 1
            if step.finer:
                level = self._finer(level, found, certificate)
            margins = step.margins
            level = with_margins(level, margins)
            found = rung(level, self.ledger, found.plan, found)
        return certificate is not None and certificate.certified

    def _finer(self, level: Case, found: Result, certificate: Certificate) -> Case:
        """The case on the next grid."""
        if self.refinement == "local" and steady(level):
            grid = found.problem.trajectory.grid
            return replace(level, mesh=halved(grid, marked(found.plan, certificate, level)))
        return on_grid(level, 2 * level.scenario.grid_intervals)


def _broken(certificate: Certificate | None) -> int:
    return len(certificate.broken) if certificate else 10**6


def _sentence(found: Result, certificate: Certificate | None, margins: Margins) -> str:
    given = {**margins["rate_margin"], **margins["contact_margin"]}
    told = ", ".join(f"{name} {share:.2%}" for name, share in given.items())
    at = f"N = {found.plan.intervals}" + (f", margins {told}" if told else "")
    if certificate is None:
        return f"{at}: {found.solved.outcome.claim}"
    verdict = "certified" if certificate.certified else certificate.reasons[0]
    return f"{at}: {found.plan.travel_time:.4f} s, {verdict}"
