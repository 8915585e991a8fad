"""A start from a plan that was stored: an earlier run, another grid, another solver's solution."""

from __future__ import annotations

from pathlib import Path
from typing import final

from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case, Guess
from benchbench.storage.files import PLAN
from benchbench.storage.playback import read_mcap

ALLOWED = "the folder of a run, or its plan.mcap"


@final
@dataclass(frozen=True)
class Previous(Guess):
    """Reads `path`: the folder of a run or its plan.mcap; any grid, the same vehicle."""

    path: str

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Raises BadInput where there is no plan for this vehicle, Unavailable without the package mcap."""
        path = Path(self.path)
        path = path / PLAN if path.is_dir() else path
        try:
            plan = read_mcap(path).plan
        except (OSError, ValueError) as error:
            raise BadInput("guess.path", f"'{path}': {error}", ALLOWED) from None
        if plan.coordinate_names != case.model.configuration.names:
            problem = f"'{path}' moves {', '.join(plan.coordinate_names)}"
            raise BadInput("guess.path", problem, f"a plan for {', '.join(case.model.configuration.names)}")
        return plan
