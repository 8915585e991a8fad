"""Orthogonal collocation (Biegler 2010, doi:10.1137/1.9780898719383, Ch. 10)."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.runge_kutta import Inputs, transcribe
from benchbench.transcription.tableau import Points, collocation


@final
@dataclass(frozen=True)
class Collocation(Dynamics):
    """Gauss-Legendre (order 2 degree) or Radau IIA (order 2 degree - 1) points; limits hold at the points.

    inputs "interval", "linear" or "polynomial": see `benchbench.transcription.runge_kutta.transcribe`.
    """

    inputs: Inputs = "interval"
    degree: Annotated[int, Field(ge=1, le=9)] = 3
    points: Points = "legendre"

    @property
    def order(self) -> int:
        """Order at the nodes for smooth inputs."""
        return collocation(self.degree, self.points).order

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        return transcribe(collocation(self.degree, self.points), self.inputs, scenario, model, grid)
