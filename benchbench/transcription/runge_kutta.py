"""Any Runge-Kutta method as a transcription, with its stages as unknowns.

Stage states and accelerations are unknowns of their own, so that the Euler-Lagrange equations are one small
function mapped over all stages of all intervals, no mass matrix is ever inverted, and limits hold at the
stages as plain bounds (no exploiting the inside of a step). With stage positions Q_i, velocities V_i and
accelerations W_i / h of an interval of length h:

    Q_i = q_0 + h sum a_ij V_j,   V_i = v_0 + sum a_ij W_j,   h (d/dt dL/dv - dL/dq - Q(Q_i, V_i, u)) = 0
    q_1 = q_0 + h sum b_j V_j,    v_1 = v_0 + sum b_j W_j

Increments W = h A have the size of velocities and the equations that of momenta; with A itself and forces,
which reach hundreds, IPOPT crept along for ten times as many iterations.

Stages that coincide with a node use the node's unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Slot, Variable, evaluated, rows
from benchbench.ocp import mechanics
from benchbench.ocp.model import ExplicitModel, Model, space
from benchbench.ocp.node import Node
from benchbench.ocp.plan import Interpolation, Plan, bernstein
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.nodal import (
    NodalTrajectory,
    cost,
    nodal_variables,
    output_limits,
    own_duration,
    total_time,
)
from benchbench.transcription.tableau import Tableau

Inputs = Literal["interval", "linear", "polynomial"]
INTERPOLATION: dict[Inputs, Interpolation] = {"interval": "hold", "linear": "linear", "polynomial": "bezier"}
State = Literal["q", "v"]
_STATES: tuple[State, State] = ("q", "v")
INCREMENTS = "w_stage"
"""Name of the unknowns W."""


def transcribe(
    tableau: Tableau, inputs: Inputs, scenario: Scenario, model: Model, grid: Grid
) -> tuple[Mpcc, Trajectory]:
    """Return nodes, stages, their equations and the cost of a scenario.

    inputs "interval": one held input per interval; "linear": nodal inputs, linear in between; "polynomial": one
    polynomial per interval with as many coefficients as stages, bounded by its Bezier control points.
    """
    points = {"interval": 1, "linear": 2}.get(inputs, tableau.stages)
    every = grid.intervals + 1 if inputs == "linear" else grid.intervals * points
    stages = Stages(tableau, grid, {"q": len(model.configuration.names), "v": len(model.velocity.names)})
    variables = nodal_variables(scenario, model, grid, every) + tuple(
        _stage_variables(stages, scenario, model)
    )
    stride = 1 if inputs == "linear" else points
    controls = [
        rows("u", len(model.inputs.names), range(j, j + stride * grid.intervals, stride))
        for j in range(points)
    ]
    motion = tuple(_euler_lagrange(stages, model, controls))
    mpcc = Mpcc(
        variables, (*_quadrature(stages, model), *motion), cost(scenario, model, grid, every, stride)
    ) + total_time(scenario, grid)
    mpcc += output_limits(scenario, model, grid)
    nodal = NodalTrajectory(grid, model, INTERPOLATION[inputs], control_points=stride)
    return mpcc, StageTrajectory(nodal, stages, motion)


@dataclass(frozen=True)
class Stages:
    """Where the unknowns of stage i of interval k are; `n` are the numbers of coordinates and velocities."""

    tableau: Tableau
    grid: Grid
    n: Mapping[State, int]

    @cached_property
    def inner(self) -> list[int]:
        """Stages that have unknowns of their own."""
        first, last = int(self.tableau.starts_at_node), self.tableau.stages - int(self.tableau.ends_at_node)
        return list(range(first, last))

    def state(self, name: State, i: int) -> Slot:
        """Q_i or V_i of every interval."""
        intervals = range(self.grid.intervals)
        if i in self.inner:
            place, count = self.inner.index(i), len(self.inner)
            return rows(f"{name}_stage", self.n[name], [k * count + place for k in intervals])
        return rows(name, self.n[name], [k + (i > 0) for k in intervals])

    def increment(self, i: int) -> Slot:
        """W_i of every interval."""
        return rows(
            INCREMENTS, self.n["v"], [k * self.tableau.stages + i for k in range(self.grid.intervals)]
        )


@dataclass(frozen=True)
class StageTrajectory:
    """A nodal trajectory whose guesses fill the stages too; `motion`: the Euler-Lagrange equations, a block for each stage."""

    nodal: NodalTrajectory
    stages: Stages
    motion: tuple[Block, ...]

    @property
    def grid(self) -> Grid:
        """The time axis."""
        return self.nodal.grid

    @property
    def node(self) -> Node:
        """Expressions of a node."""
        return self.nodal.node

    @property
    def equations(self) -> tuple[str, ...]:
        """Names of the equations of motion from node to node where all stages are nodes, else none."""
        return () if self.stages.inner else ("q_node", "v_node")

    def increments(self, read: Callable[[Block], Sequence[Array]]) -> Array:
        """Return W (N stages, n_v) by which the Euler-Lagrange equations hold, which are linear in it.

        read: what a block reads, slot by slot, (N, size) each; the numbers of W play no part.
        """
        found = [_increment(block, read(block)) for block in self.motion]
        return np.stack(found, axis=1).reshape(-1, self.stages.n["v"])

    def slots(self, nodes: Sequence[int]) -> tuple[Slot, ...]:
        """Unknowns of `node.z`."""
        return self.nodal.slots(nodes)

    def parameters(self, nodes: Sequence[int]) -> Array:
        """Numbers of each node."""
        return self.nodal.parameters(nodes)

    def decode(self, values: dict[str, Array], progress: Array) -> Plan:
        """Turn named values into a plan of the nodes."""
        return self.nodal.decode(values, progress)

    def encode(self, plan: Plan, durations: Array | None = None) -> dict[str, Array]:
        """Interpolate the plan at nodes and stages."""
        values = self.nodal.encode(plan, durations)
        time = self.grid.time_weights @ values["T"].ravel()
        h, c = np.diff(time)[:, None], self.stages.tableau.c
        at = (time[:-1, None] + h * c[self.stages.inner]).ravel()
        for name in _STATES:
            columns = [np.interp(at, time, column) for column in values[name].T]
            values[f"{name}_stage"] = np.stack(columns, axis=-1)
        values[INCREMENTS] = np.repeat(np.diff(values["v"], axis=0), self.stages.tableau.stages, axis=0)
        return values


def _increment(block: Block, reads: Sequence[Array]) -> Array:
    """W of one stage of every interval, (N, n_v): a residual that is linear in it, by its values at 0 and at unit vectors."""
    names = [slot.variable for slot in block.slots]

    def left(w: Array) -> Array:
        z = [np.broadcast_to(w, r.shape) if n == INCREMENTS else r for n, r in zip(names, reads, strict=True)]
        return evaluated(block, np.hstack(z))

    unit = np.eye(reads[names.index(INCREMENTS)].shape[1])
    rest = left(np.zeros(len(unit)))
    mass = np.stack([left(one) - rest for one in unit], axis=-1)
    return np.asarray(np.linalg.solve(mass, -rest[..., None])[..., 0])


def _stage_variables(stages: Stages, scenario: Scenario, model: Model) -> Iterator[Variable]:
    count = stages.grid.intervals * len(stages.inner)
    if count:
        q = scenario.limits(model)
        flown = np.repeat(scenario.flown(model, stages.grid.intervals + 1)[:-1], len(stages.inner))
        rates = scenario.planned_rates_at(model, flown)
        boxes = {"q": [np.tile(b, (count, 1)) for b in (q.lower, q.upper)], "v": rates}
        for name, (low, high) in boxes.items():
            yield Variable(f"{name}_stage", low, high, np.clip(np.zeros_like(low), low, high))
    free = np.full((stages.grid.intervals * stages.tableau.stages, stages.n["v"]), np.inf)
    yield Variable(INCREMENTS, -free, free, np.zeros_like(free))


def _quadrature(stages: Stages, model: Model) -> Iterator[Block]:
    """State equations of inner stages and of the right node, separately for each stage and for q and v."""
    a, b = stages.tableau.a, stages.tableau.b
    right = range(1, stages.grid.intervals + 1)
    for i in stages.inner:
        yield _positions(f"q_stage_{i}", stages, model, stages.state("q", i), a[i], False)
    yield _positions("q_node", stages, model, rows("q", stages.n["q"], right), b, True)
    for i in stages.inner:
        yield _velocities(f"v_stage_{i}", stages, stages.state("v", i), a[i])
    yield _velocities("v_node", stages, rows("v", stages.n["v"], right), b)


def _velocities(name: str, stages: Stages, end: Slot, weights: Array) -> Block:
    """Row end - start - sum w_j W_j = 0; weights are parameters: one function for all methods."""
    used = [j for j, weight in enumerate(weights) if weight != 0.0]
    n, m, count = stages.n["v"], len(used), stages.grid.intervals
    first, last, slope = ca.SX.sym("first", n), ca.SX.sym("last", n), ca.SX.sym("slope", n, m)
    p = ca.SX.sym("p", m)
    z = ca.vertcat(first, last, ca.vec(slope))
    function = ca.Function(f"increment_{m}", [z, p, ca.SX.sym("sigma")], [last - first - slope @ p])
    slots = (rows("v", n, range(count)), end, *(stages.increment(j) for j in used))
    zero = np.zeros((count, n))
    numbers = np.tile(weights[used], (count, 1))
    return Block(name, function, slots, parameters=numbers, lower=zero, upper=zero, unit="m/s, rad/s")


def _positions(name: str, stages: Stages, model: Model, end: Slot, weights: Array, at_node: bool) -> Block:
    """Row end - start - h sum w_j dq/dt_j = 0, with dq/dt from Q_j and V_j where it is not V_j itself.

    At nodes the sum is normalised: a quaternion that may grow or shrink scales the thrust.
    """
    used = [j for j, weight in enumerate(weights) if weight != 0.0]
    n, k, m, count = stages.n["q"], stages.n["v"], len(used), stages.grid.intervals
    first, last = ca.SX.sym("first", n), ca.SX.sym("last", n)
    place, speed = ca.SX.sym("Q", n, m), ca.SX.sym("V", k, m)
    lives = space(model)
    slopes = [lives.kinematics(place[:, j], speed[:, j]) for j in range(m)]
    plain = n == k and all(ca.is_equal(slope, speed[:, j]) for j, slope in enumerate(slopes))
    duration, p = ca.SX.sym("T"), ca.SX.sym("p", 1 + m)
    ahead = first + p[0] * duration * (ca.horzcat(*slopes) @ p[1:])
    gap = last - (lives.normalised(ahead) if at_node else ahead)
    read = speed if plain else ca.vertcat(place, speed)
    z = ca.vertcat(first, last, ca.vec(read), duration)
    function = ca.Function(f"quadrature_{m}", [z, p, ca.SX.sym("sigma")], [gap])
    parts: tuple[State, ...] = ("v",) if plain else _STATES
    own, share = own_duration(stages.grid)
    slots = (rows("q", n, range(count)), end, *(stages.state(s, j) for j in used for s in parts), own)
    numbers, zero = np.hstack([share, np.tile(weights[used], (count, 1))]), np.zeros((count, n))
    return Block(name, function, slots, parameters=numbers, lower=zero, upper=zero, unit="m, rad")


def _euler_lagrange(stages: Stages, model: Model, controls: list[Slot]) -> Iterator[Block]:
    """H (d/dt dL/dv - dL/dq - Q) = 0 at every stage of every interval; p = [step weights, c_i].

    Where the model gives its acceleration W - H dv/dt = 0.
    """
    n, n_u, count = stages.n["v"], len(model.inputs.names), stages.grid.intervals
    q, v, w = ca.SX.sym("q", stages.n["q"]), ca.SX.sym("v", n), ca.SX.sym("w", n)
    u = [ca.SX.sym(f"u{j}", n_u) for j in range(len(controls))]
    duration, p = ca.SX.sym("T"), ca.SX.sym("p", 2)
    h, c = p[0] * duration, p[1]
    here = sum((weight * point for weight, point in zip(bernstein(len(u), c), u, strict=True)), ca.SX(0))
    if isinstance(model, ExplicitModel):
        residual = w - h * model.acceleration(q, v, here)
    else:
        lagrangian = mechanics.lagrangian_model(model)
        momentum, drift = mechanics.momentum_drift(lagrangian, q, v)
        rate = mechanics.momentum_rate(lagrangian, q, v, here)
        residual = ca.jtimes(momentum, v, w) + h * (drift - rate)
    function = ca.Function(
        "euler_lagrange", [ca.vertcat(q, v, w, *u, duration), p, ca.SX.sym("sigma")], [residual]
    )
    zero = np.zeros((count, n))
    own, share = own_duration(stages.grid)
    for i, place in enumerate(stages.tableau.c):
        slots = (
            stages.state("q", i),
            stages.state("v", i),
            stages.increment(i),
            *controls,
            own,
        )
        numbers = np.hstack([share, np.full((count, 1), place)])
        yield Block(
            f"euler_lagrange_{i}", function, slots,
            parameters=numbers, lower=zero, upper=zero, unit="kg m/s, kg m^2/s",
        )  # fmt: skip
