"""Trapezoidal collocation (Betts 2010, doi:10.1137/1.9780898718577, Sec. 4.5)."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.dynamics import Dynamics, Grid, Trajectory
from benchbench.model import Model
from benchbench.mpcc import Mpcc
from benchbench.runge_kutta import Inputs, transcribe
from benchbench.scenario import Scenario
from benchbench.tableau import TRAPEZOIDAL


@final
@dataclass(frozen=True)
class Trapezoidal(Dynamics):
    """Implicit trapezoidal rule (Lobatto IIIA, two stages); both stages are nodes, so limits hold at nodes only.

    inputs "interval", "linear" or "polynomial": see `benchbench.runge_kutta.transcribe`.
    """

    inputs: Inputs = "linear"

    @property
    def order(self) -> int:
        """Second order."""
        return 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        return transcribe(TRAPEZOIDAL, self.inputs, scenario, model, grid)
