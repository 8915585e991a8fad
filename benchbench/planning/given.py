"""A plan that is there already: nothing is solved, it is only judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from benchbench.certificate.audit import claimed
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case, Strategy
from benchbench.planning.result import Result


@final
@dataclass(frozen=True)
class Given(Strategy):
    """Returns the plan that it was given; dynamics, relaxation, solver and guess of the case play no part.

    planner  who made it, the record's solver
    """

    plan: Plan
    planner: str

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Return it; one that claims no contact is taken to claim the longest that it has."""
        plan = claimed(self.plan, case.scenario.itinerary, case.model.plant(), case.limits)
        return Result(planned=plan, planner=self.planner)
