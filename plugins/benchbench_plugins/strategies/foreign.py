"""A plan from a file, whoever made it: judged, recorded and drawn like ours."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, final

from pydantic.dataclasses import dataclass

from benchbench.certificate.audit import claimed
from benchbench.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.result import Result
from benchbench.storage.flight import plan_of
from benchbench.storage.flight_csv import read_csv


@final
@dataclass(frozen=True)
class Foreign(Strategy):
    """Nothing is solved: the plan is read from a CSV file (docs/foreign_plans.md).

    file           the CSV file
    planner        who made it, the record's solver
    interpolation  of its inputs: "hold", those of a row until the next; "linear", from row to row

    Dynamics, relaxation, solver and guess of the case play no part.
    """

    file: Path | None = None
    planner: str = "foreign"
    interpolation: Literal["hold", "linear"] = "hold"

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Read; a plan that claims no contact is taken to claim the longest that it has. Raises BadInput."""
        if self.file is None:
            raise BadInput("strategy.file", "none was given", "the path of a CSV file with a plan")
        plan = plan_of(read_csv(self.file), case.model, self.interpolation)
        found = claimed(plan, case.scenario.itinerary, case.model.plant(), case.limits)
        return Result(planned=found, planner=self.planner)
