"""Classical Runge-Kutta method of order four by multiple shooting (Kutta 1901)."""

from __future__ import annotations

from typing import Annotated, Literal, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput
from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import ExplicitModel, Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription import shooting
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.runge_kutta import Inputs, transcribe
from benchbench.transcription.tableau import RK4, composed


@final
@dataclass(frozen=True)
class Rk4(Dynamics):
    """Explicit Runge-Kutta, `steps` equal steps inside each interval.

    form "stages": stages are unknowns (see `benchbench.transcription.runge_kutta`), which is the same method: the limits hold at
    every stage, and the inverse of the mass matrix is never needed. "shooting": stages are eliminated (see
    `benchbench.transcription.shooting`), limits hold at nodes; a third of the unknowns. "auto": shooting for a model that gives
    its accelerations, stages for one with a Lagrangian only and for polynomial inputs.
    inputs "interval", "linear" or "polynomial": see `benchbench.transcription.runge_kutta.transcribe`.
    """

    inputs: Inputs = "interval"
    form: Literal["auto", "stages", "shooting"] = "auto"
    steps: Annotated[int, Field(ge=1, le=20)] = 1

    def __post_init__(self) -> None:
        """Refuse polynomials without stages; raises BadInput."""
        if self.form == "shooting" and self.inputs == "polynomial":
            raise BadInput("dynamics.form", "shooting takes no polynomial inputs", "stages, auto")

    @property
    def order(self) -> int:
        """Fourth order."""
        return 4

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        tableau = composed(RK4, self.steps)
        wanted = "shooting" if isinstance(model, ExplicitModel) else "stages"
        if self.inputs == "polynomial" or (wanted if self.form == "auto" else self.form) == "stages":
            return transcribe(tableau, self.inputs, scenario, model, grid)
        return shooting.transcribe(tableau, self.inputs, scenario, model, grid)
