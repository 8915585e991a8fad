"""Verlet DMOC: discrete mechanics and optimal control with the Verlet discrete Lagrangian (paper Sec. III.B)."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.nodal import Velocities
from benchbench.transcription.variational import Discrete, Gradient, Inputs, transcribe


@final
@dataclass(frozen=True)
class Verlet(Dynamics):
    """Two-point form of the forced discrete Euler-Lagrange equations; second order.

    L_d(q_0, q_1) = h/2 L(q_0, w) + h/2 L(q_1, w), w = (q_1 - q_0) / h (paper Eq. 21); rows as in
    `benchbench.transcription.variational`.

    inputs "interval": one held input, f^- = h/2 Q(q_k, u_k), f^+ = h/2 Q(q_{k+1}, u_k), what a controller does.
    inputs "nodal":    f^- = h/2 Q(q_k, u_k), f^+ = h/2 Q(q_{k+1}, u_{k+1}), replayed as a linear input.
    inputs "averaged": f^- = f^+ = h/4 (Q_k + Q_{k+1}), the paper's Eq. 15; alternating inputs are invisible to it.
    velocity "nodal": limits and contacts act on v_k. "mean": on (q_{k+1} - q_k) / h, as the paper.
    """

    needs_lagrangian: ClassVar[bool] = True
    needs_vector_space: ClassVar[bool] = True

    inputs: Inputs = "interval"
    velocity: Velocities = "nodal"

    @property
    def order(self) -> int:
        """Second order."""
        return 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return variables, Legendre rows and cost."""
        return transcribe("verlet", _rule, self.inputs, self.velocity, scenario, model, grid)


def _rule(
    momentum: Gradient, slope: Gradient, q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, h: ca.SX
) -> Discrete:
    w = (q1 - q0) / h
    shared = (momentum(q0, w) + momentum(q1, w)) / 2
    return Discrete(h / 2 * slope(q0, w) - shared, (q0, v0), (q1, v1))
