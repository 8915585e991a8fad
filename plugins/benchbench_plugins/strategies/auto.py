"""Solve on a coarse grid, fly the plan, let the certificate's findings decide what is next, until it is certified."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.sizes import Tries
from benchbench.planning.case import Case, Strategy
from benchbench.planning.disturb import disturbed
from benchbench.planning.loop import Loop, Refinement
from benchbench.planning.result import Result
from benchbench.planning.strategy import start_seed


@final
@dataclass(frozen=True)
class Auto(Strategy):
    """Phases on a ladder of grids, with the replay as judge (`benchbench.planning.loop`).

    finer       a grid is refined as long as it has fewer than so many times the intervals of the scenario
    margin      largest share of a limit left unused because the replay exceeded it between nodes
    refinement  local: a grid is refined where the replay found errors; uniform: everywhere
    correction  errors of the transcription are taken off its equations, on the same grid (deferred correction), rather than refined
    starts      how many starts are tried until one is certified
    patience    iterations granted to a solve that is not the last start's: a good start needs a tenth of that
    """

    finer: Annotated[int, Field(ge=1, le=64)] = 8
    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5
    refinement: Refinement = "local"
    correction: bool = True
    starts: Tries = 4
    patience: Tries = 400

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Return the first certified result; without one that with the fewest broken limits."""
        finest = self.finer * case.scenario.grid_intervals
        loop = Loop(case, ledger, finest, self.margin, self.refinement, self.correction)
        guessed = case.guess.plan(case, ledger)
        for attempt in range(self.starts):
            last = attempt == self.starts - 1
            limit = case.iteration_limit if last else min(case.iteration_limit, self.patience)
            start = disturbed(guessed, case, start_seed(case.seed, attempt))
            if loop.certifies(replace(case, iteration_limit=limit), start) or loop.conflict or ledger.over:
                break
        return loop.best.telling(refinement=loop.told, **loop.account)
