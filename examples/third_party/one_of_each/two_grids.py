"""Phases on a coarse grid first."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

import benchbench as bb
from benchbench.planning import posing
from benchbench.planning.guess import first_plan
from benchbench.planning.strategy import pose


@final
@dataclass(frozen=True)
class TwoGrids(bb.Strategy):
    """Solve phases on `share` of the intervals, then on all of them from what that found (nested iteration).

    The way from a poor guess is gone where an iteration is cheap. Margins are those of the scenario.
    """

    share: Annotated[float, Field(gt=0, lt=1)] = 0.25

    def solve(self, case: bb.Case, ledger: bb.Ledger) -> bb.Result:
        """Solve twice. Raises IncompatibleCase for a race, whose grid counts intervals per gate."""
        scenario = case.scenario.on_grid(max(8, round(self.share * case.scenario.intervals)))
        if scenario is None:
            raise bb.IncompatibleCase("strategy", "'two_grids' plans handovers", "phases")
        coarse = replace(case, scenario=scenario)
        found = _phases(coarse, first_plan(coarse, ledger), ledger, "coarse")
        return _phases(case, found.plan, ledger, "fine")


def _phases(case: bb.Case, start: bb.Plan, ledger: bb.Ledger, stage: str) -> bb.Result:
    with ledger.building():
        problem = posing.phases(case, start)
    return pose(problem, case, ledger, stage)
