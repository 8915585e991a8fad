"""What transcriptions with unknowns at the nodes have in common: variables, ends, cost, reading a node.

Unknowns: q (N + 1, n_q), v (N + 1, n_v) nodal velocities, u (N or N + 1, n_u), T (phases, 1) durations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.mpcc.problem import Block, Mpcc, Slot, Variable, block, rows
from benchbench.ocp.cost import Cost
from benchbench.ocp.model import Model, output, output_box
from benchbench.ocp.node import Node
from benchbench.ocp.plan import Interpolation, Plan
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.touching import motors
from benchbench.transcription.grid import Grid

Velocities = Literal["nodal", "mean"]


@dataclass(frozen=True)
class NodalTrajectory:
    """Reads unknowns q, v, u, T (see `benchbench.transcription.dynamics.Trajectory`).

    velocities "nodal": the velocity of node k is v_k. "mean": it is (q_{k+1} - q_k) / h_k, as the paper
    limits it; the last node has none.
    equations: names of the blocks that are the equations of motion, where they read nothing but nodes and inputs.
    """

    grid: Grid
    model: Model
    interpolation: Interpolation
    velocities: Velocities = "nodal"
    control_points: int = 1
    equations: tuple[str, ...] = ()

    @property
    def node(self) -> Node:
        """Expressions of node k: z = [q_k, v_k, T] or [q_k, q_{k+1}, T], p = [time weights, step weights]."""
        n, phases = len(self.model.configuration.names), len(self.grid.phases)
        q, second = ca.SX.sym("q", n), ca.SX.sym("second", len(self.model.velocity.names))
        duration, p = ca.SX.sym("T", phases), ca.SX.sym("p", 2 * phases)
        time, step = ca.dot(p[:phases], duration), ca.dot(p[phases:], duration)
        velocity = second if self.velocities == "nodal" else (second - q) / step
        return Node(ca.vertcat(q, second, duration), p, time, q, velocity)

    def slots(self, nodes: Sequence[int]) -> tuple[Slot, ...]:
        """Unknowns of `node.z`."""
        n, m = len(self.model.configuration.names), len(self.model.velocity.names)
        second = rows("v", m, nodes) if self.velocities == "nodal" else rows("q", n, [k + 1 for k in nodes])
        return (rows("q", n, nodes), second, durations(self.grid, len(nodes)))

    def parameters(self, nodes: Sequence[int]) -> Array:
        """Time and step weights of each node, (nodes, 2 phases)."""
        which = np.asarray(nodes, dtype=int)
        steps = self.grid.step_weights[np.minimum(which, self.grid.intervals - 1)]
        return np.hstack([self.grid.time_weights[which], steps])

    def decode(self, values: dict[str, Array], progress: Array) -> Plan:
        """Turn named values into a plan."""
        return Plan.of(
            self.model, time=self.grid.time_weights @ values["T"].ravel(), configuration=values["q"],
            velocity=values["v"], inputs=values["u"], progress=progress, interpolation=self.interpolation,
        )  # fmt: skip

    def encode(self, plan: Plan, durations: Array | None = None) -> dict[str, Array]:
        """Sample a plan at this grid's nodes, its travel time spread over the phases as they are guessed."""
        duration = np.array([phase.guess for phase in self.grid.phases] if durations is None else durations)
        if durations is None:
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


def own_duration(grid: Grid, intervals: Sequence[int] | None = None) -> tuple[Slot, Array]:
    """Slot of the duration T of each interval's own phase, and its share of it: h = share T, (intervals, 1)."""
    phase = np.repeat(np.arange(len(grid.phases)), [p.intervals for p in grid.phases])
    share = np.concatenate([p.steps for p in grid.phases])[:, None]
    which = np.arange(grid.intervals) if intervals is None else np.asarray(intervals)
    return rows("T", 1, phase[which]), share[which]


def nodal_variables(
    scenario: Scenario, model: Model, grid: Grid, input_rows: int, velocity_limits: bool = True
) -> tuple[Variable, ...]:
    """q, v, u, T with their bounds; fixed start, guesses are a straight line at hover."""
    start, end = scenario.start_point(model), scenario.end_point(model)
    q, last = scenario.limits(model), scenario.ends(model)
    nodes = grid.intervals + 1
    share = np.linspace(0.0, 1.0, nodes)[:, None]
    flown = scenario.flown(model, nodes)
    low_v, high_v = scenario.planned_rates_at(model, flown)
    if not velocity_limits:
        low_v, high_v = np.full_like(low_v, -np.inf), np.full_like(high_v, np.inf)
    low_q, high_q = (np.tile(b, (nodes, 1)) for b in (q.lower, q.upper))
    u_ref = model.hover()
    low_u, high_u = scenario.planned_inputs_at(model, flown[input_intervals(grid, input_rows)])
    if scenario.hover_ends:
        low_u[[0, -1]] = high_u[[0, -1]] = u_ref
    line = (1 - share) * start + share * end
    way = np.zeros_like(low_v)
    if way.shape == line.shape:
        way += (end - start) / scenario.travel_time_guess
    return (
        _with_ends("q", low_q, high_q, start, (last.lower_q, last.upper_q), line),
        _with_ends("v", low_v, high_v, scenario.start_rates(model), (last.lower_v, last.upper_v), way),
        Variable("u", low_u, high_u, np.tile(u_ref, (input_rows, 1))),
        Variable("T", _column(grid, "lower"), _column(grid, "upper"), _column(grid, "guess"), "s"),
    )


def input_intervals(grid: Grid, input_rows: int) -> Index:
    """Node at which the limits of each row of inputs hold: its own, or the first of its interval."""
    if input_rows == grid.intervals + 1:
        return np.arange(input_rows)
    return np.arange(input_rows) // (input_rows // grid.intervals)


def cost(
    scenario: Scenario, model: Model, grid: Grid, input_rows: int, per_interval: int = 1
) -> tuple[Block, ...]:
    """t_N + c_u sum_k h_k |u_k - u_ref|^2 (paper Eq. 33, squared as in the authors' public demo code), and the scenario's own terms.

    With `per_interval` control points in each interval each has its share of the step; no effort for c_u = 0.
    """
    if scenario.input_cost == 0.0:
        return (travel_time(grid), *_own_costs(scenario, model, grid, per_interval, input_rows))
    interval = np.minimum(np.arange(input_rows) // per_interval, grid.intervals - 1)
    slot, steps = own_duration(grid, interval.tolist())
    steps = steps / per_interval
    constants = np.tile([scenario.input_cost, *model.hover()], (input_rows, 1))
    given = motors(model)

    def effort(u: ca.SX, own: ca.SX, p: ca.SX) -> ca.SX:
        return p[1] * p[0] * own * ca.sumsqr((u - p[2:])[given])

    slots, numbers = (
        (rows("u", len(model.inputs.names), range(input_rows)), slot),
        np.hstack([steps, constants]),
    )
    return (
        travel_time(grid),
        block("input_cost", slots, effort, parameters=numbers, unit="s", symbols="u T"),
        *_own_costs(scenario, model, grid, per_interval, input_rows),
    )


def _own_costs(
    scenario: Scenario, model: Model, grid: Grid, per_interval: int, input_rows: int
) -> Iterator[Block]:
    """Each cost term of the scenario by the trapezoidal rule, with the inputs at both ends of every interval."""
    left, right, inputs = range(grid.intervals), range(1, grid.intervals + 1), len(model.inputs.names)
    first = [k * per_interval for k in left]
    last = list(right) if input_rows == grid.intervals + 1 else [k + per_interval - 1 for k in first]
    own, share = own_duration(grid)
    sizes = {"q": len(model.configuration.names), "v": len(model.velocity.names)}
    slots = [rows(name, size, which) for which in (left, right) for name, size in sizes.items()]
    slots += [rows("u", inputs, which) for which in ([first] if first == last else [first, last])]
    for name, term in scenario.costs.items():

        def spent(*reads: ca.SX, term: Cost = term) -> ca.SX:
            q0, v0, q1, v1, *u, duration, p = reads
            price = term.rate(model, q0, v0, u[0]) + term.rate(model, q1, v1, u[-1])
            return p * duration * price / 2

        yield block(f"cost_{name}", (*slots, own), spent, parameters=share, unit="s")


def travel_time(grid: Grid) -> Block:
    """The sum of all durations, as a cost."""
    return block("travel_time", (durations(grid, 1),), ca.sum1, unit="s", symbols="T")


def total_time(scenario: Scenario, grid: Grid) -> Mpcc:
    """Limit the sum of all durations where there are several phases (one phase has it as a bound)."""
    if len(grid.phases) == 1:
        return Mpcc()
    total = block("total_time", (durations(grid, 1),), ca.sum1, *scenario.travel_time, unit="s", symbols="T")
    return Mpcc((), (total,))


def output_limits(scenario: Scenario, model: Model, grid: Grid) -> Mpcc:
    """Limit the model's outputs y(q_k, v_k) at every node but the first, which is given."""
    if not output_box(model).names:
        return Mpcc()
    low, high = scenario.planned_outputs_at(model, scenario.flown(model, grid.intervals + 1))
    finite = np.flatnonzero(np.isfinite(low).any(axis=0) | np.isfinite(high).any(axis=0)).tolist()
    sizes, nodes = (len(model.configuration.names), len(model.velocity.names)), range(1, grid.intervals + 1)
    slots = [rows(name, size, nodes) for name, size in zip("qv", sizes, strict=True)]

    def limited(q: ca.SX, v: ca.SX) -> ca.SX:
        return output(model, q, v)[finite]

    bounds = low[1:, finite], high[1:, finite]
    return Mpcc((), (block("outputs", slots, limited, *bounds, unit="rad, rad/s", symbols="q v"),))


def each_interval(
    name: str, grid: Grid, model: Model, inputs_per_interval: int, rule: Callable[..., ca.SX], unit: str,
    bounds: tuple[float, float] = (0.0, 0.0),
) -> Block:  # fmt: skip
    """Block `rule(q0, v0, q1, v1, u0, [u1], h)` on every interval, rows bounded by `bounds`."""
    sizes = {"q": len(model.configuration.names), "v": len(model.velocity.names)}
    left, right = range(grid.intervals), range(1, grid.intervals + 1)
    own, share = own_duration(grid)
    slots = (
        *(rows(k, sizes[k], which) for which in (left, right) for k in ("q", "v")),
        *(rows("u", len(model.inputs.names), which) for which in (left, right)[:inputs_per_interval]),
        own,
    )

    def row(*reads: ca.SX) -> ca.SX:
        *state_and_inputs, duration, p = reads
        return rule(*state_and_inputs, p * duration)

    symbols = "q0 v0 q1 v1 u0 T" if inputs_per_interval == 1 else "q0 v0 q1 v1 u0 u1 T"
    return block(name, slots, row, *bounds, parameters=share, unit=unit, symbols=symbols)


def _with_ends(
    name: str, lower: Array, upper: Array, first: Array, last: tuple[Array, Array], guess: Array
) -> Variable:
    lower[0] = upper[0] = guess[0] = first
    lower[-1], upper[-1] = last
    guess[-1] = np.clip(guess[-1], *last)
    return Variable(name, lower, upper, guess)


def _column(grid: Grid, what: str) -> Array:
    return np.array([[getattr(phase, what)] for phase in grid.phases])


def _sample(time: Array, values: Array, at: Array) -> Array:
    return np.stack([np.interp(at, time, column) for column in values.T], axis=-1)
