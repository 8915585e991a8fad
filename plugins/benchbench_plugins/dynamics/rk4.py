"""Classical Runge-Kutta method of order four by multiple shooting (Kutta 1901)."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.dynamics import Dynamics, Grid, Trajectory
from benchbench.model import Model
from benchbench.mpcc import Mpcc
from benchbench.runge_kutta import Inputs, transcribe
from benchbench.scenario import Scenario
from benchbench.tableau import RK4, composed


@final
@dataclass(frozen=True)
class Rk4(Dynamics):
    """Explicit Runge-Kutta, `steps` equal steps inside each interval.

    Stages are unknowns (see `benchbench.runge_kutta`), which is the same method: the limits hold at every
    stage, and the explicit form never needs the inverse of the mass matrix.
    inputs "interval", "linear" or "polynomial": see `benchbench.runge_kutta.transcribe`.
    """

    inputs: Inputs = "interval"
    steps: Annotated[int, Field(ge=1, le=20)] = 1

    @property
    def order(self) -> int:
        """Fourth order."""
        return 4

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        return transcribe(composed(RK4, self.steps), self.inputs, scenario, model, grid)
