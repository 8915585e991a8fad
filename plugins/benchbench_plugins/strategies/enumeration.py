"""The contact window as a discrete choice, each choice a smooth problem: from coarse to fine grids."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.guess import first_plan
from benchbench.planning.loop import settled
from benchbench.planning.margins import least_margins, with_margins
from benchbench.planning.result import Result
from benchbench.planning.windows import Windows, check_one_contact, coarser, solved_again


@final
@dataclass(frozen=True)
class Enumeration(Strategy):
    """Contact at kappa_init nodes from node k on, k searched; equal steps as in the paper, no complementarity.

    On each of `levels` grids, twice as fine as the one before, the search walks downhill from where the last one has
    its minimum. With `exhaustive` every window of the finest grid that its lower bound does not rule out is solved as well. The
    account says how many were solved, ruled out and left; each solve is local. Margins as for `phases`. Where they do not help, the
    best window is solved on grids twice as fine, as long as these have fewer than `finer` times the intervals.
    """

    exhaustive: bool = False
    levels: Annotated[int, Field(ge=1, le=6)] = 3
    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5
    finer: Annotated[int, Field(ge=1, le=64)] = 4

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Search; where the replay asks for margins or a finer grid, go on from the best window.

        Raises IncompatibleCase unless one contact is to be held for kappa_init nodes.
        """
        check_one_contact(case)
        least = least_margins(case.scenario, self.margin)
        found = self._search(with_margins(case, least), ledger)
        return settled(case, ledger, found, self.finer, self.margin, least, _again)

    def _search(self, case: Case, ledger: Ledger) -> Result:
        coarsest, *finer = coarser(case, self.levels)
        windows = Windows(coarsest, ledger, first_plan(case, ledger), bounded=not finer)
        windows.descend(windows.nearest)
        for level in finer:
            last, best, finest = windows, windows.best, level is finer[-1]
            windows = Windows(level, ledger, best.plan, best, bounded=finest)
            windows.descend(windows.first_at(last.valley))
        if self.exhaustive:
            windows.exhaust()
        return replace(windows.best, account={"search": windows.account().told("windows")})


def _again(case: Case, ledger: Ledger, near: Result, correct: bool) -> Result:
    """The window of a result once more, on another grid the nearest one."""
    return solved_again(case, ledger, near, correct)
