"""The fast planner for contacts or gates whose order is known: phases, no complementarity."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.ocp.sizes import Tries
from benchbench.planning import posing
from benchbench.planning.case import Case, Strategy
from benchbench.planning.ladder import rung
from benchbench.planning.margins import measured
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose, retried


@final
@dataclass(frozen=True)
class Phases(Strategy):
    """Smooth solves with free durations before and after each contact; races: from gate to gate.

    The relaxation of the case plays no part. A solve that claims no success is tried again from another start,
    `attempts` times in all, each but the last with at most `patience` iterations (a good start needs 30 to 100). Margins are those that the replay asks
    for, up to `margin` (a share of a limit), instead of the scenario's; with margin 0 the scenario's.
    """

    attempts: Tries = 4
    patience: Tries = 400
    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, solve; where the replay asks for margins once more with them, from plan and multipliers."""

        def once(case: Case, start: Plan) -> Result:
            with ledger.building():
                problem = posing.phases(case, start)
            return pose(problem, case, ledger, "phases")

        def repeatedly(case: Case, near: Result | None) -> Result:
            if near is not None:
                return rung(case, ledger, near.plan, near)
            return retried(case, ledger, self.attempts, self.patience, once)

        return measured(case, ledger, self.margin, repeatedly)
