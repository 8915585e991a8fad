"""After any strategy: the contact set it found, held, without complementarity; moved while that improves."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import ConfigDict, Field, InstanceOf
from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.margins import measured
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge, planned
from benchbench.planning.windows import Windows, check_one_contact, solved_again


@final
@dataclass(frozen=True, config=ConfigDict(arbitrary_types_allowed=True))
class Polish(Strategy):
    """Run `after`, hold contact at the nodes it found, solve that smooth problem, move the window left and right.

    Of this and the result of `after` the certified one is returned, of two certified ones the cheaper. Margins as for
    `phases`.
    """

    after: InstanceOf[Strategy]
    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Solve, then walk downhill over windows; where the replay asks for margins, solve the best one again.

        Raises IncompatibleCase unless one contact is to be held for kappa_init nodes.
        """
        check_one_contact(case)
        found = planned(self.after, case, ledger)

        def search(case: Case, near: Result | None) -> Result:
            if near is not None:
                return solved_again(case, ledger, near)
            windows = Windows(case, ledger, found.plan)
            best = windows.descend(windows.nearest).best
            return best.telling(search=windows.account().told("windows"))

        polished = measured(case, ledger, self.margin, search)
        if not polished.claimed:
            return found
        certified = [result for result in (found, polished) if judge(result, case, ledger).certified]
        return min(certified, key=lambda result: result.objective, default=polished)
