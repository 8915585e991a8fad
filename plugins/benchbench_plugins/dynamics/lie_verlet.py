"""Verlet on a Lie group: variational, in unit quaternions without singularity (Kobilarov & Marsden 2011).

Discrete geometric optimal control on Lie groups, doi:10.1109/TRO.2011.2139130; the difference of quaternions as in
Manchester & Peck 2016, Quaternion variational integrators for spacecraft dynamics, doi:10.2514/1.G001176.
"""

from __future__ import annotations

from functools import partial
from typing import ClassVar, Literal, final

import casadi as ca
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import Model, space
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.variational import Discrete, Gradient, Inputs, transcribe


@final
@dataclass(frozen=True)
class LieVerlet(Dynamics):
    """Two-point form on any configuration space, second order; on a vector space it is `verlet`.

    L_d(q_0, q_1) = h/2 L(q_0, w) + h/2 L(q_1, w), w = difference(q_0, q_1) / h the constant velocity that leads from
    q_0 to q_1. D_1, D_2 are derivatives along dq/dt = K(q) v, so that the rows are momenta dual to v:

        D_1 L_d = h/2 K_0^T dL/dq(q_0, w) + J_0^T m,

    with J_0 = d difference / dq_0 K_0 and m the mean of dL/dv(q_0, w) and dL/dv(q_1, w).
    inputs as in `verlet`. forces "trapezoid": at both nodes, as in `verlet`; "simpson": also at the Hermite midpoint of
    the interval, where the vehicle has turned: for races, where it needs less than half the nodes.
    """

    needs_lagrangian: ClassVar[bool] = True

    inputs: Inputs = "interval"
    forces: Literal["trapezoid", "simpson"] = "trapezoid"

    @property
    def order(self) -> int:
        """Second order."""
        return 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return variables, Legendre rows, rows of unit length and cost."""
        rule = partial(_rule, model, self.forces == "simpson")
        return transcribe("lie_verlet", rule, self.inputs, "nodal", scenario, model, grid)


def _rule(
    model: Model,
    simpson: bool,
    momentum: Gradient,
    slope: Gradient,
    q0: ca.SX,
    v0: ca.SX,
    q1: ca.SX,
    v1: ca.SX,
    h: ca.SX,
) -> Discrete:
    lives = space(model)
    difference = lives.difference(q0, q1)
    w = difference / h
    mean = (momentum(q0, w) + momentum(q1, w)) / 2
    along = ca.jacobian(lives.kinematics(q0, v0), v0)
    d1 = along.T @ (h / 2 * slope(q0, w) + ca.jacobian(difference, q0).T @ mean)
    bend = h / 8 * (lives.kinematics(q0, v0) - lives.kinematics(q1, v1))
    middle = lives.normalised((q0 + q1) / 2 + bend), (v0 + v1) / 2
    return Discrete(d1, (q0, v0), (q1, v1), middle if simpson else None)
