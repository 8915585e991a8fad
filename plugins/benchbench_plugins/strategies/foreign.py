"""A plan from a file, whoever made it: judged, recorded and drawn like ours."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, final

from pydantic.dataclasses import dataclass

from benchbench.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.given import Given
from benchbench.planning.result import Result
from benchbench.storage.plan_file import read_plan


@final
@dataclass(frozen=True)
class Foreign(Strategy):
    """Nothing is solved: the plan is read from a file (docs/foreign_plans.md).

    file           CSV, or a plan.mcap of ours
    planner        who made it, the record's solver
    interpolation  of its inputs: "hold", those of a row until the next; "linear", from row to row; of no meaning
                   where the file says it itself (a frame, a recording)

    Dynamics, relaxation, solver and guess of the case play no part.
    """

    file: Path | None = None
    planner: str = "foreign"
    interpolation: Literal["hold", "linear"] = "hold"

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Read; a plan that claims no contact is taken to claim the longest that it has. Raises BadInput."""
        if self.file is None:
            raise BadInput("strategy.file", "none was given", "the path of a file with a plan")
        plan = read_plan(self.file, case.model, self.interpolation)
        return Given(plan, self.planner).solve(case, ledger)
