"""What variational integrators in two-point form have in common: from a discrete Lagrangian to rows.

With nodal velocities as unknowns the discrete Legendre transforms (paper Eq. 17) give two rows per interval:

    leaving node k:      dL/dv(q_k, v_k)         + D_1 L_d + f^-  = 0
    arriving at k + 1:   dL/dv(q_{k+1}, v_{k+1}) - D_2 L_d - f^+  = 0

Eliminating v gives the forced discrete Euler-Lagrange equations and boundary conditions (paper Eq. 16, 19). On a
manifold D_1, D_2 are derivatives along dq/dt = K(q) v, and rows keep the nodes where configurations live.

Every rule here is its own adjoint, L_d(q_0, q_1, h) = -L_d(q_1, q_0, -h): flown backwards, an interval leaves node k + 1
by the row that arrives there. So both rows are one function, differentiated and compiled once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import casadi as ca
import numpy as np

from benchbench.mpcc.problem import Block, Mpcc
from benchbench.ocp import mechanics
from benchbench.ocp.model import Coordinates, LagrangianModel, Model, space
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.nodal import (
    NodalTrajectory,
    Velocities,
    cost,
    each_interval,
    nodal_variables,
    output_limits,
    total_time,
)

Inputs = Literal["interval", "nodal", "averaged"]


@dataclass(frozen=True)
class Discrete:
    """One interval: D_1 L_d (n_v,), and where the discrete forces are taken.

    `left`, `right` are (q, v) pairs; the forces are f^- = h/2 Q(left, u), f^+ = h/2 Q(right, u). With a `middle`
    they are integrals of (1 - s) Q and s Q by Simpson's rule, f^- = h/6 Q(left) + h/3 Q(middle), f^+ alike.
    """

    d1: ca.SX
    left: tuple[ca.SX, ca.SX]
    right: tuple[ca.SX, ca.SX]
    middle: tuple[ca.SX, ca.SX] | None = None


Gradient = Callable[[ca.SX, ca.SX], ca.SX]
Rule = Callable[[Gradient, Gradient, ca.SX, ca.SX, ca.SX, ca.SX, ca.SX], Discrete]
"""(dL/dv, dL/dq, q_0, v_0, q_1, v_1, h) -> Discrete, of a discrete Lagrangian that is its own adjoint."""


def transcribe(
    name: str, rule: Rule, inputs: Inputs, velocity: Velocities, scenario: Scenario, model: Model, grid: Grid
) -> tuple[Mpcc, Trajectory]:
    """Return variables, Legendre rows, cost (and mean-velocity limits) of a scenario."""
    held, lagrangian = inputs == "interval", mechanics.lagrangian_model(model)
    input_rows = grid.intervals + (not held)
    variables = nodal_variables(scenario, model, grid, input_rows, velocity == "nodal")
    row = _legendre_row(lagrangian, rule, inputs)
    leaving = each_interval(name, grid, model, 1 if held else 2, row, "kg m/s, kg m^2/s")
    legendre = (replace(leaving, name=f"{name}_leaving"), _backwards(leaving, f"{name}_arriving"))
    places = () if space(model).flat else _places(model, grid)
    limits = () if velocity == "nodal" else (_mean_limits(scenario.planned_rates(model), model, grid),)
    mpcc = Mpcc(variables, (*legendre, *places, *limits), cost(scenario, model, grid, input_rows))
    mpcc += output_limits(scenario, model, grid)
    equations = tuple(block.name for block in legendre)
    trajectory = NodalTrajectory(grid, model, "hold" if held else "linear", velocity, equations=equations)
    return mpcc + total_time(scenario, grid), trajectory


def _legendre_row(model: LagrangianModel, rule: Rule, inputs: Inputs) -> Callable[..., ca.SX]:
    momentum, slope = _lagrangian_gradients(model)

    def row(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, *rest: ca.SX) -> ca.SX:
        *u, h = rest
        one = rule(momentum, slope, q0, v0, q1, v1, h)
        force = model.force(*one.left, u[0])
        if one.middle:
            force = force / 3 + 2 / 3 * model.force(*one.middle, (u[0] + u[-1]) / 2)
        if inputs == "averaged":
            force = (force + model.force(*one.right, u[-1])) / 2
        return momentum(q0, v0) + one.d1 + h / 2 * force

    return row


def _backwards(block: Block, name: str) -> Block:
    """The same rows of every interval from its right node to its left one, h < 0."""
    q0, v0, q1, v1, *u, duration = block.slots
    slots = (q1, v1, q0, v0, *reversed(u), duration)
    return replace(block, name=name, slots=slots, parameters=-block.parameters)


def _lagrangian_gradients(model: LagrangianModel) -> tuple[Gradient, Gradient]:
    q, v = ca.SX.sym("q", len(model.configuration.names)), ca.SX.sym("v", len(model.velocity.names))
    lagrangian = model.lagrangian(q, v)
    return (
        ca.Function("momentum", [q, v], [ca.gradient(lagrangian, v)]),
        ca.Function("slope", [q, v], [ca.gradient(lagrangian, q)]),
    )


def _places(model: Model, grid: Grid) -> tuple[Block, ...]:
    """Zero where configurations live, at the right node of every interval."""

    def rule(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, u: ca.SX, h: ca.SX) -> ca.SX:
        return space(model).constraint(q1)

    return (each_interval("constraint", grid, model, 1, rule, "1"),)


def _mean_limits(limits: Coordinates, model: Model, grid: Grid) -> Block:
    """q_1 - q_0 - h v_max <= 0 and q_0 - q_1 + h v_min <= 0 on every interval (paper Eq. 22)."""
    finite = np.flatnonzero(np.isfinite(limits.upper)).tolist()
    low, high = ca.DM(limits.lower[finite]), ca.DM(limits.upper[finite])

    def rule(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, u: ca.SX, h: ca.SX) -> ca.SX:
        step = (q1 - q0)[finite]
        return ca.vertcat(step - h * high, h * low - step)

    return each_interval("mean_velocity", grid, model, 1, rule, "m, rad", (-np.inf, 0.0))
