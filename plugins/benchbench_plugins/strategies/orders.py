"""In which order to pass the gates of a race: branch and bound over orders, each flown as phases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch
from typing import final

from pydantic.dataclasses import dataclass

from benchbench.certificate.race_bound import order_bound
from benchbench.ground.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.planning import posing
from benchbench.planning.case import Case, Strategy
from benchbench.planning.result import Result
from benchbench.planning.search import Candidate, Found, best_first
from benchbench.planning.strategy import pose

GateOrder = tuple[int, ...]


@final
@dataclass(frozen=True)
class Orders(Strategy):
    """Branch and bound over the orders of the gates, from the smallest lower bound on (scenario.order=free).

    An order begun is bounded by largest thrust alone (`benchbench.certificate.race_bound`), which is a proof; a whole one
    is one smooth solve, which is local. So the account proves that no other order has a better plan than the bounds or
    the local solutions say, and counts the orders that were split, solved, pruned, failed, or left for want of time.
    """

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Bound, branch, solve."""
        race, model = open_race(case.scenario), case.model
        if race is None:
            raise BadInput(
                "strategy", "'orders' needs the gates of a race in free order", "scenario.order=free"
            )
        numbers, plant = range(1, len(race.listed) + 1), model.plant()

        def begun(order: GateOrder) -> Candidate[GateOrder]:
            return Candidate(order, order_bound(race, model, plant, order))

        def split(order: GateOrder) -> Sequence[Candidate[GateOrder]]:
            return [begun((*order, i)) for i in numbers if i not in order]

        best, account = best_first(
            [begun(())],
            lambda order: self._fly(case, ledger, race, order),
            lambda: not ledger.over,
            split,
        )
        return replace(best.result, account={"search": account.told("orders, whole or begun")})

    def _fly(self, case: Case, ledger: Ledger, race: Race, order: GateOrder) -> Found[Result]:
        ordered = replace(case, scenario=race.flown_in(order))
        start = posing.start(ordered, ledger)
        with ledger.building():
            problem = posing.phases(ordered, start)
        result = pose(problem, ordered, ledger, f"phases: {', '.join(map(str, order))}")
        return Found(result, result.objective)


@singledispatch
def open_race(scenario: Scenario) -> Race | None:
    """Return the race whose gates may be passed in any order; None where the scenario leaves no order open."""
    return None


@open_race.register
def _(scenario: Race) -> Race | None:
    return scenario if scenario.order == "free" else None
