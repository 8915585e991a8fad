"""What transcriptions with unknowns at the nodes have in common: variables, ends, cost, reading a node.

Unknowns: q (N + 1, n_q), v (N + 1, n_q) nodal velocities, u (N or N + 1, n_u), T (phases, 1) durations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from benchbench.dynamics import Grid, Node
from benchbench.model import Model
from benchbench.mpcc import Block, Mpcc, Slot, Variable, rows
from benchbench.plan import Array, Interpolation, Plan
from benchbench.scenario import Scenario

Velocities = Literal["nodal", "mean"]


@dataclass(frozen=True)
class NodalTrajectory:
    """Reads unknowns q, v, u, T (see `benchbench.dynamics.Trajectory`).

    velocities "nodal": the velocity of node k is v_k. "mean": it is (q_{k+1} - q_k) / h_k, as the paper
    limits it; the last node has none.
    """

    grid: Grid
    model: Model
    interpolation: Interpolation
    velocities: Velocities = "nodal"
    control_points: int = 1

    @property
    def node(self) -> Node:
        """Expressions of node k: z = [q_k, v_k, T] or [q_k, q_{k+1}, T], p = [time weights, step weights]."""
        n, phases = len(self.model.configuration.names), len(self.grid.phases)
        q, second = ca.SX.sym("q", n), ca.SX.sym("second", n)
        duration, p = ca.SX.sym("T", phases), ca.SX.sym("p", 2 * phases)
        time, step = ca.dot(p[:phases], duration), ca.dot(p[phases:], duration)
        velocity = second if self.velocities == "nodal" else (second - q) / step
        return Node(ca.vertcat(q, second, duration), p, time, q, velocity)

    def slots(self, nodes: Sequence[int]) -> tuple[Slot, ...]:
        """Unknowns of `node.z`."""
        n = len(self.model.configuration.names)
        second = rows("v", n, nodes) if self.velocities == "nodal" else rows("q", n, [k + 1 for k in nodes])
        return (rows("q", n, nodes), second, durations(self.grid, len(nodes)))

    def parameters(self, nodes: Sequence[int]) -> Array:
        """Time and step weights of each node, (nodes, 2 phases)."""
        which = np.asarray(nodes, dtype=int)
        steps = self.grid.step_weights[np.minimum(which, self.grid.intervals - 1)]
        return np.hstack([self.grid.time_weights[which], steps])

    def decode(self, values: dict[str, Array], progress: Array) -> Plan:
        """Turn named values into a plan."""
        c, u = self.model.configuration, self.model.inputs
        return Plan(
            time=self.grid.time_weights @ values["T"].ravel(),
            configuration=values["q"], velocity=values["v"], inputs=values["u"], progress=progress,
            interpolation=self.interpolation, coordinate_names=c.names, coordinate_units=c.units,
            input_names=u.names, input_units=u.units,
        )  # fmt: skip

    def encode(self, plan: Plan) -> dict[str, Array]:
        """Sample a plan at this grid's nodes, its travel time spread over the phases as they are guessed."""
        duration = np.array([phase.guess for phase in self.grid.phases])
        duration *= plan.travel_time / duration.sum()
        time = self.grid.time_weights @ duration
        return {
            "q": _sample(plan.time, plan.configuration, time),
            "v": _sample(plan.time, plan.velocity, time),
            "u": plan.input_at(self._input_times(time)),
            "T": duration[:, None],
        }

    def _input_times(self, time: Array) -> Array:
        if self.interpolation == "linear":
            return time
        share = (np.arange(self.control_points) + 0.5) / self.control_points
        return np.asarray(time[:-1, None] + np.diff(time)[:, None] * share).ravel()


def durations(grid: Grid, instances: int) -> Slot:
    """Slot that gives every instance all phase durations."""
    return rows("T", len(grid.phases), [0] * instances)


def nodal_variables(
    scenario: Scenario, model: Model, grid: Grid, input_rows: int, velocity_limits: bool = True
) -> tuple[Variable, ...]:
    """q, v, u, T with their bounds; start and end are fixed and at rest, guesses are a straight line at hover."""
    start, end = scenario.start_point(model), scenario.end_point(model)
    q = scenario.limits(model)
    nodes = grid.intervals + 1
    share = np.linspace(0.0, 1.0, nodes)[:, None]
    v = scenario.planned_rates(model)
    far = np.full_like(v.lower, np.inf)
    low_v, high_v = (v.lower, v.upper) if velocity_limits else (-far, far)
    rest = np.zeros_like(start)
    total = scenario.travel_time_guess
    u_ref = model.hover()
    low_u, high_u = (np.tile(b, (input_rows, 1)) for b in (model.inputs.lower, model.inputs.upper))
    if scenario.hover_ends:
        low_u[[0, -1]] = high_u[[0, -1]] = u_ref
    return (
        _with_ends("q", q.lower, q.upper, start, end, (1 - share) * start + share * end, nodes),
        _with_ends("v", low_v, high_v, rest, rest, np.tile((end - start) / total, (nodes, 1)), nodes),
        Variable("u", low_u, high_u, np.tile(u_ref, (input_rows, 1))),
        Variable("T", _column(grid, "lower"), _column(grid, "upper"), _column(grid, "guess"), "s"),
    )


def cost(
    scenario: Scenario, model: Model, grid: Grid, input_rows: int, per_interval: int = 1
) -> tuple[Block, ...]:
    """t_N + c_u sum_k h_k |u_k - u_ref|^2 (paper Eq. 33, squared as in the authors' public demo code).

    With `per_interval` control points in each interval each has its share of the step.
    """
    phases, n_u = len(grid.phases), len(model.inputs.names)
    s = ca.SX.sym("sigma")
    duration = ca.SX.sym("T", phases)
    time = ca.Function("travel_time", [duration, ca.SX.sym("p", 0), s], [ca.sum1(duration)])
    u, weights, p = ca.SX.sym("u", n_u), ca.SX.sym("T", phases), ca.SX.sym("p", phases + 1 + n_u)
    effort = p[phases] * ca.dot(p[:phases], weights) * ca.sumsqr(u - p[phases + 1 :])
    interval = np.minimum(np.arange(input_rows) // per_interval, grid.intervals - 1)
    steps = grid.step_weights[interval] / per_interval
    constants = np.tile([scenario.input_cost, *model.hover()], (input_rows, 1))
    none = np.zeros((input_rows, 1))
    return (
        Block("travel_time", time, (durations(grid, 1),), np.zeros((1, 0)), none[:1], none[:1], "s"),
        Block(
            "input_cost", ca.Function("input_cost", [ca.vertcat(u, weights), p, s], [effort]),
            (rows("u", n_u, range(input_rows)), durations(grid, input_rows)), np.hstack([steps, constants]),
            none, none, "s",
        ),
    )  # fmt: skip


def total_time(scenario: Scenario, grid: Grid) -> Mpcc:
    """Limit the sum of all durations where there are several phases (one phase has it as a bound)."""
    if len(grid.phases) == 1:
        return Mpcc()
    duration = ca.SX.sym("T", len(grid.phases))
    function = ca.Function(
        "total_time", [duration, ca.SX.sym("p", 0), ca.SX.sym("sigma")], [ca.sum1(duration)]
    )
    low, high = (np.array([[bound]]) for bound in scenario.travel_time)
    return Mpcc((), (Block("total_time", function, (durations(grid, 1),), np.zeros((1, 0)), low, high, "s"),))


def each_interval(
    name: str, grid: Grid, model: Model, inputs_per_interval: int, rule: Callable[..., ca.SX], unit: str,
    bounds: tuple[float, float] = (0.0, 0.0),
) -> Block:  # fmt: skip
    """Block `rule(q0, v0, q1, v1, u0, [u1], h)` on every interval, rows bounded by `bounds`."""
    n, n_u, phases, count = (
        len(model.configuration.names),
        len(model.inputs.names),
        len(grid.phases),
        grid.intervals,
    )
    state = [ca.SX.sym(k, n) for k in ("q0", "v0", "q1", "v1")]
    inputs = [ca.SX.sym(f"u{i}", n_u) for i in range(inputs_per_interval)]
    duration, p = ca.SX.sym("T", phases), ca.SX.sym("p", phases)
    out = rule(*state, *inputs, ca.dot(p, duration))
    function = ca.Function(name, [ca.vertcat(*state, *inputs, duration), p, ca.SX.sym("sigma")], [out])
    left, right = range(count), range(1, count + 1)
    slots = (
        *(rows(k, n, which) for which in (left, right) for k in ("q", "v")),
        *(rows("u", n_u, which) for which in (left, right)[:inputs_per_interval]),
        durations(grid, count),
    )
    low, high = (np.full((count, out.shape[0]), bound) for bound in bounds)
    return Block(name, function, slots, grid.step_weights, low, high, unit)


def _with_ends(
    name: str, low: Array, high: Array, first: Array, last: Array, guess: Array, nodes: int
) -> Variable:
    lower, upper = np.tile(low, (nodes, 1)), np.tile(high, (nodes, 1))
    lower[0] = upper[0] = guess[0] = first
    lower[-1] = upper[-1] = guess[-1] = last
    return Variable(name, lower, upper, guess)


def _column(grid: Grid, what: str) -> Array:
    return np.array([[getattr(phase, what)] for phase in grid.phases])


def _sample(time: Array, values: Array, at: Array) -> Array:
    return np.stack([np.interp(at, time, column) for column in values.T], axis=-1)
