"""From a coarse grid to finer ones, each started from the last: until the certified travel time settles."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import ConfigDict, Field, InstanceOf
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.sizes import INTERVALS
from benchbench.planning.case import Case, Strategy
from benchbench.planning.guess import GivenStart
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge, planned
from benchbench.planning.validate import numbers


@final
@dataclass(frozen=True, config=ConfigDict(arbitrary_types_allowed=True))
class Refine(Strategy):
    """Solve by `of` on grids of `coarsest`, twice, four times ... as many intervals, at most `finest`.

    Stops when two grids in a row are certified and their travel times differ by no more than `tolerance`, a share. Of the
    intervals of the scenario only the contact knows, whose nodes they count: it lasts as long on every grid. Returns the
    finest certified plan, else the finest.
    """

    of: InstanceOf[Strategy]
    coarsest: Annotated[int, Field(ge=8, le=INTERVALS)] = 25
    finest: Annotated[int, Field(ge=8, le=INTERVALS)] = 400
    tolerance: Annotated[float, Field(gt=0, lt=1)] = 0.005

    def __post_init__(self) -> None:
        """Refuse a finest grid that is coarser than the coarsest; raises BadInput."""
        if self.finest < self.coarsest:
            problem = f"{self.finest} is below strategy.coarsest"
            raise BadInput("strategy.finest", problem, f"at least {self.coarsest}")

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Solve, judge, refine.

        Raises IncompatibleCase for a scenario with one grid only, and BadInput for contacts that do not fit into the
        coarsest one.
        """
        numbers(_on_grid(case, self.coarsest))
        told: list[str] = []
        found: list[tuple[Result, bool]] = []
        intervals = self.coarsest
        while not found or (intervals <= self.finest and not ledger.over):
            level = _on_grid(case, intervals)
            if found:
                level = replace(level, guess=GivenStart(found[-1][0].plan), seed=0)
            result = planned(self.of, level, ledger)
            found.append((result, judge(result, level, ledger).certified))
            verdict = "certified" if found[-1][1] else "not certified"
            told.append(f"N = {intervals}: {result.plan.travel_time:.4f} s, {verdict}")
            if self._settled(found):
                told.append(f"settled within {self.tolerance:.2%}")
                break
            intervals *= 2
        best = next((result for result, certified in reversed(found) if certified), found[-1][0])
        return best.telling(refinement=told)

    def _settled(self, found: list[tuple[Result, bool]]) -> bool:
        if len(found) < 2 or not all(certified for _, certified in found[-2:]):
            return False
        before, after = (result.plan.travel_time for result, _ in found[-2:])
        return abs(after - before) <= self.tolerance * after


def _on_grid(case: Case, intervals: int) -> Case:
    scenario = case.scenario.on_grid(intervals)
    if scenario is None:
        raise IncompatibleCase(
            "strategy", "'refine' needs another grid, the scenario has one", "auto, phases"
        )
    return replace(case, scenario=scenario)
