"""Trapezoidal collocation (Betts 2010, doi:10.1137/1.9780898718577, Sec. 4.5)."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.runge_kutta import Inputs, transcribe
from benchbench.transcription.tableau import TRAPEZOIDAL


@final
@dataclass(frozen=True)
class Trapezoidal(Dynamics):
    """Implicit trapezoidal rule (Lobatto IIIA, two stages); both stages are nodes, so limits hold at nodes only.

    inputs "interval", "linear" or "polynomial": see `benchbench.transcription.runge_kutta.transcribe`. "linear" is Betts' form; there
    neighbours share an input, and one that alternates from node to node adds up to nothing in every row: rates swing between nodes, unseen.
    """

    inputs: Inputs = "interval"

    @property
    def order(self) -> int:
        """Second order."""
        return 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        return transcribe(TRAPEZOIDAL, self.inputs, scenario, model, grid)
