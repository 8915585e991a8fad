"""Hermite-Simpson collocation in separated form (Hargraves & Paris 1987, doi:10.2514/3.20223)."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.runge_kutta import Inputs, transcribe
from benchbench.transcription.tableau import HERMITE_SIMPSON


@final
@dataclass(frozen=True)
class HermiteSimpson(Dynamics):
    """Lobatto IIIA with three stages: nodes and midpoint; limits hold at all of them.

    inputs "interval", "linear" or "polynomial": see `benchbench.transcription.runge_kutta.transcribe`. "linear" hides an input that
    alternates from node to node from the velocities at nodes, as in `trapezoidal`: contacts, which are kept at nodes, are passed in between.
    """

    inputs: Inputs = "interval"

    @property
    def order(self) -> int:
        """Fourth order."""
        return 4

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        return transcribe(HERMITE_SIMPSON, self.inputs, scenario, model, grid)
