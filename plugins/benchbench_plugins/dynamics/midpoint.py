"""Variational midpoint rule (Marsden & West 2001, doi:10.1017/S096249290100006X, Ex. 2.3.2)."""

from __future__ import annotations

from typing import ClassVar, Literal, final

import casadi as ca
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.variational import Discrete, Gradient, transcribe


@final
@dataclass(frozen=True)
class Midpoint(Dynamics):
    """L_d(q_0, q_1) = h L((q_0 + q_1) / 2, (q_1 - q_0) / h), rows as in `benchbench.transcription.variational`; second order.

    Forces are taken at the midpoint, f^- = f^+ = h/2 Q. inputs "interval": one held input; "averaged": the
    mean of the nodal ones, replayed as a linear input.
    """

    inputs: Literal["interval", "averaged"] = "interval"

    needs_lagrangian: ClassVar[bool] = True
    needs_vector_space: ClassVar[bool] = True

    @property
    def order(self) -> int:
        """Second order."""
        return 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return variables, Legendre rows and cost."""
        return transcribe("midpoint", _rule, self.inputs, "nodal", scenario, model, grid)


def _rule(
    momentum: Gradient, slope: Gradient, q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, h: ca.SX
) -> Discrete:
    middle, w = (q0 + q1) / 2, (q1 - q0) / h
    return Discrete(h / 2 * slope(middle, w) - momentum(middle, w), (middle, w), (middle, w))
