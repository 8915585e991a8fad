"""Verlet DMOC: discrete mechanics and optimal control with the Verlet discrete Lagrangian (paper Sec. III.B)."""

from __future__ import annotations

from typing import Literal, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.dynamics import Dynamics, Grid, Trajectory
from benchbench.model import Coordinates, Model
from benchbench.mpcc import Block, Mpcc
from benchbench.scenario import Scenario
from benchbench.transcription import NodalTrajectory, cost, each_interval, nodal_variables, total_time


@final
@dataclass(frozen=True)
class Verlet(Dynamics):
    """Two-point form of the forced discrete Euler-Lagrange equations; second order.

    L_d(q_0, q_1) = h/2 L(q_0, w) + h/2 L(q_1, w), w = (q_1 - q_0) / h (paper Eq. 21). With nodal velocities
    as unknowns the discrete Legendre transforms (paper Eq. 17) give two rows per interval:

        leaving node k:      M(q_k) v_k         + dL_d/dq_k     + f^-  = 0
        arriving at k + 1:   M(q_{k+1}) v_{k+1} - dL_d/dq_{k+1} - f^+  = 0

    Eliminating v gives the paper's Eq. 16 and 19.

    inputs "interval": one held input, f^- = h/2 Q(q_k, u_k), f^+ = h/2 Q(q_{k+1}, u_k), what a controller does.
    inputs "nodal":    f^- = h/2 Q(q_k, u_k), f^+ = h/2 Q(q_{k+1}, u_{k+1}), replayed as a linear input.
    inputs "averaged": f^- = f^+ = h/4 (Q_k + Q_{k+1}), the paper's Eq. 15; alternating inputs are invisible to it.
    velocity "nodal": limits and contacts act on v_k. "mean": on (q_{k+1} - q_k) / h, as the paper.
    """

    inputs: Literal["interval", "nodal", "averaged"] = "interval"
    velocity: Literal["nodal", "mean"] = "nodal"
    order: int = 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return variables, Legendre rows, cost (and mean-velocity limits) of a scenario."""
        held = self.inputs == "interval"
        input_rows = grid.intervals + (not held)
        variables = nodal_variables(scenario, model, grid, input_rows, self.velocity == "nodal")
        legendre = each_interval(
            "verlet", grid, model, 1 if held else 2, self._rule(model), "kg m/s, kg m^2/s"
        )
        constraints = (
            (legendre,)
            if self.velocity == "nodal"
            else (legendre, _mean_limits(scenario.planned_rates(model), model, grid))
        )
        mpcc = Mpcc(variables, constraints, cost(scenario, model, grid, input_rows)) + total_time(
            scenario, grid
        )
        return mpcc, NodalTrajectory(grid, model, "hold" if held else "linear", self.velocity)

    def _rule(self, model: Model):  # type: ignore[no-untyped-def]
        def rule(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, *rest: ca.SX) -> ca.SX:
            *u, h = rest
            momentum, slope = _lagrangian_gradients(model)
            mean = (q1 - q0) / h
            shared = (momentum(q0, mean) + momentum(q1, mean)) / 2
            d1, d2 = h / 2 * slope(q0, mean) - shared, h / 2 * slope(q1, mean) + shared
            left, right = model.force(q0, v0, u[0]), model.force(q1, v1, u[-1])
            if self.inputs == "averaged":
                left = right = (left + right) / 2
            leaving = momentum(q0, v0) + d1 + h / 2 * left
            arriving = momentum(q1, v1) - d2 - h / 2 * right
            return ca.vertcat(leaving, arriving)

        return rule


def _lagrangian_gradients(model: Model) -> tuple[ca.Function, ca.Function]:
    n = len(model.configuration.names)
    q, v = ca.SX.sym("q", n), ca.SX.sym("v", n)
    lagrangian = model.lagrangian(q, v)
    return (
        ca.Function("momentum", [q, v], [ca.gradient(lagrangian, v)]),
        ca.Function("slope", [q, v], [ca.gradient(lagrangian, q)]),
    )


def _mean_limits(limits: Coordinates, model: Model, grid: Grid) -> Block:
    """q_1 - q_0 - h v_max <= 0 and q_0 - q_1 + h v_min <= 0 on every interval (paper Eq. 22)."""
    finite = np.flatnonzero(np.isfinite(limits.upper)).tolist()
    low, high = ca.DM(limits.lower[finite]), ca.DM(limits.upper[finite])

    def rule(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, u: ca.SX, h: ca.SX) -> ca.SX:
        step = (q1 - q0)[finite]
        return ca.vertcat(step - h * high, h * low - step)

    return each_interval("mean_velocity", grid, model, 1, rule, "m, rad", (-np.inf, 0.0))
