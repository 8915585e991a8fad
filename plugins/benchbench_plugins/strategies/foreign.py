"""A plan from a file, whoever made it: judged, recorded and drawn like ours."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, final

from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.given import Given
from benchbench.planning.motors import hint, order_of, reordered
from benchbench.planning.result import Result
from benchbench.storage.plan_file import read_plan


@final
@dataclass(frozen=True)
class Foreign(Strategy):
    """Nothing is solved: the plan is read from a file (docs/foreign_plans.md).

    file           CSV, a plan.mcap of ours, or what `benchbench export` made of one
    planner        who made it, the record's solver
    interpolation  of its inputs: "hold", those of a row until the next; "linear", from row to row; of no meaning
                   where the file says it itself (a frame, a recording)
    motors         how the file numbers the motors: the name of a convention, or for each of ours its number there

    Dynamics, relaxation, solver and guess of the case play no part.
    """

    file: Path | None = None
    planner: str = "foreign"
    interpolation: Literal["hold", "linear"] = "hold"
    motors: str | tuple[int, int, int, int] = "ours"

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Read; a plan that claims no contact is taken to claim the longest that it has. Raises BadInput.

        Where the first intervals fit another order of the motors, the advice says so.
        """
        order = order_of(self.motors, case.model)
        if self.file is None:
            raise BadInput("strategy.file", "none was given", "the path of a file with a plan")
        plan = reordered(read_plan(self.file, case.model, self.interpolation), order)
        found = Given(plan, self.planner).solve(case, ledger)
        said = hint(plan, case.model, case.limits, order)
        return found.telling(advice=said) if said else found
