"""A Runge-Kutta method for stiff vehicles: its tableau, and everything else is the framework's."""

from __future__ import annotations

from typing import final

import numpy as np
from pydantic.dataclasses import dataclass

import benchbench as bb
from benchbench.transcription.runge_kutta import Inputs, transcribe
from benchbench.transcription.tableau import Tableau

TABLEAU = Tableau(
    np.array([[1 / 6, -1 / 3, 1 / 6], [1 / 6, 5 / 12, -1 / 12], [1 / 6, 2 / 3, 1 / 6]]),
    np.array([1, 4, 1]) / 6, np.array([0, 0.5, 1.0]), 4,
)  # fmt: skip


@final
@dataclass(frozen=True)
class LobattoIiic(bb.Dynamics):
    """Lobatto IIIC with three stages (Hairer & Wanner 1996, Sec. IV.5): damps what is faster than a step.

    inputs "interval" (held), "linear" or "polynomial".
    """

    inputs: Inputs = "interval"

    @property
    def order(self) -> int:
        """Fourth order."""
        return TABLEAU.order

    def transcribe(
        self, scenario: bb.Scenario, model: bb.Model, grid: bb.Grid
    ) -> tuple[bb.Mpcc, bb.Trajectory]:
        """Return nodes, stages, their equations and the cost."""
        return transcribe(TABLEAU, self.inputs, scenario, model, grid)
