"""Which stops, and in what order: every allowed sequence as a flight of phases, the best one returned."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.certificate.speed_bound import sequence_bound
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.stop import Stop
from benchbench.planning import posing
from benchbench.planning.case import Case, Strategy
from benchbench.planning.margins import measured
from benchbench.planning.result import Result
from benchbench.planning.search import Candidate, Found, best_first
from benchbench.planning.strategy import pose


@final
@dataclass(frozen=True)
class Sequences(Strategy):
    """Enumeration over phase sequences, from the smallest lower bound on, pruned by the best cost so far.

    The bound is that of speed limits and reach, less the rewards; it is a proof for plans that keep these limits, without
    the tolerances of the certificate. Each solve is smooth and local: what
    is returned is the best of the local optima of all sequences that were not pruned, and the account says how many
    were solved, pruned, failed or left for want of time. Margins as for `phases`, for the best sequence only.
    """

    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Search; where the replay asks for margins, solve the best sequence again."""

        def search(case: Case, near: Result | None) -> Result:
            return self._search(case, ledger) if near is None else self._again(case, ledger, near)

        return measured(case, ledger, self.margin, search)

    def _search(self, case: Case, ledger: Ledger) -> Result:
        """Bound, sort, solve."""
        scenario, model = case.scenario, case.model
        plant = model.plant()

        def candidate(made: tuple[Stop, ...]) -> Candidate[tuple[Stop, ...]]:
            worth = sum(stop.reward or 0.0 for stop in made)
            return Candidate(made, sequence_bound(scenario, made, model, plant) - worth)

        best, account = best_first(
            (candidate(made) for made in scenario.itinerary.sequences()),
            lambda made: self._fly(case, ledger, made),
            lambda: not ledger.over,
        )
        return replace(best.result, account={"search": account.told("sequences")})

    def _again(self, case: Case, ledger: Ledger, near: Result) -> Result:
        """Solve the sequence of a result once more, from its plan."""
        with ledger.building():
            problem = posing.phases(case, near.plan)
        return pose(problem, case, ledger, "phases: the best again")

    def _fly(self, case: Case, ledger: Ledger, made: tuple[Stop, ...]) -> Found[Result]:
        start = posing.start(case, ledger, made)
        with ledger.building():
            problem = posing.phases(case, start)
        names = ", ".join(stop.name for stop in made) or "no stop"
        result = pose(problem, case, ledger, f"phases: {names}")
        return Found(result, result.objective)
