"""The fast planner for contacts or gates whose order is known: phases, no complementarity."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench import posing
from benchbench.case import Case, Ledger
from benchbench.plan import Plan
from benchbench.strategy import Result, Strategy, pose, retried


@final
@dataclass(frozen=True)
class Phases(Strategy):
    """One smooth solve with free durations before and after the contact; races: from gate to gate.

    The relaxation of the case plays no part. A solve that claims no success is tried again from another start,
    `attempts` times in all, each but the last with at most `patience` iterations.
    """

    attempts: Annotated[int, Field(ge=1)] = 4
    patience: Annotated[int, Field(ge=1)] = 400

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, solve."""

        def once(case: Case, start: Plan) -> Result:
            with ledger.building():
                problem = posing.phases(case, start)
            return pose(problem, case, ledger, "phases")

        return retried(case, ledger, self.attempts, self.patience, once)
