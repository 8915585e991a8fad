"""A plan by an external planner, in a child process on the same track and limits."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import ConfigDict, Field, InstanceOf
from pydantic.dataclasses import dataclass

from benchbench.certificate.audit import claimed
from benchbench.ground.errors import BadInput
from benchbench.mpcc.spending import cpu_s
from benchbench.nlp.ledger import Ledger, Spent
from benchbench.planning.case import Case, Strategy
from benchbench.planning.peer import Peer, ask
from benchbench.planning.result import Result


@final
@dataclass(frozen=True, config=ConfigDict(arbitrary_types_allowed=True))
class External(Strategy):
    """The planner chosen with peer=NAME; its plan is judged like ours (docs/foreign_plans.md).

    planner     the peer
    wall_limit  wall seconds after which it is killed; None: the time limit of the run

    Dynamics, relaxation, solver and guess of the case play no part.
    """

    planner: InstanceOf[Peer] | None = None
    wall_limit: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Ask it; its CPU time, start included, counts as that of a solver."""
        if self.planner is None:
            raise BadInput("peer", "none was chosen", "peer=NAME with a NAME that `benchbench plugins` lists")
        before = cpu_s()
        plan = ask(self.planner, case, min(self.wall_limit or ledger.seconds_left, ledger.seconds_left))
        ledger.solves.append(Spent("peer", cpu_s() - before, None))
        found = claimed(plan, case.scenario.itinerary, case.model.plant(), case.limits)
        return Result(planned=found, planner=self.planner.name)
