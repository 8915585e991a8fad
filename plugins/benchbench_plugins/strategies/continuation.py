"""A homotopy for MPCCs that nobody scaled or guessed for us."""

from __future__ import annotations

from typing import final

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.homotopy import Path, Solved, homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.method import Method
from benchbench.nlp.relaxation import Relaxation
from benchbench.ocp.sizes import TRIES
from benchbench.planning.case import Case, MpccStrategy
from benchbench.planning.result import Result


@final
@dataclass(frozen=True)
class Continuation(MpccStrategy):
    """Any relaxation with its sigma driven from `first` to `last` by `factor`, all three as products G H.

    Penalties have no such product: there all three are sigma itself, one over the penalty parameter.

    A relaxation's own schedule starts where the handover's good guess is. A ready-made problem starts anywhere:
    over 603 of them sigma_0 of 0.1 to 10 was best (Nurkanovic, Pozharskiy & Diehl 2024,
    doi:10.1007/s10013-024-00704-z). A sigma that fails is reached for again in smaller steps.
    """

    first: float = Field(default=1.0, gt=0)
    last: float = Field(default=1e-9, gt=0)
    factor: float = Field(default=0.1, gt=0, lt=1)
    retries: int = Field(default=5, ge=0, le=TRIES)

    def __post_init__(self) -> None:
        """Refuse a path that leads upwards; raises BadInput."""
        if self.last > self.first:
            raise BadInput(
                "strategy.last", f"{self.last:g} is above strategy.first", f"at most {self.first:g}"
            )

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Flights have their own."""
        problem = "'continuation' is for problems that come ready-made, but this is a flight"
        raise IncompatibleCase("strategy", problem, "relax, phases")

    def solve_mpcc(self, mpcc: Mpcc, case: Method, ledger: Ledger) -> Solved:
        """Relax, from the guess the problem comes with."""
        return homotopy(
            mpcc,
            case,
            ledger,
            "relaxation",
            path=Path(self._schedule(case.relaxation), self.retries, self.last),
        )

    def _schedule(self, relaxation: Relaxation) -> tuple[float, ...]:
        if relaxation.power == 0:
            return relaxation.schedule
        steps = round(np.log(self.last / self.first) / np.log(self.factor))
        products = np.geomspace(self.first, self.last, steps + 1)
        return tuple(float(s) for s in products ** (1 / relaxation.power))
