"""What is required of a dynamics plugin, whatever its unknowns are called; how it converges is in `orders`.

square        start, times and inputs determine everything else
reading       decode(encode(plan)) is the plan; the node view says what decode says, on any phases
limits        the scenario's limits of coordinates, rates, inputs and travel time are kept at every node,
              as bounds or as inequality rows; start and end are fixed by bounds
cost          t_N + c_u sum h |u - u_ref|^2, over the inputs that motors give
Control points of curved inputs ("bezier") are only guessed by encode, so their reading and limits are not checked.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import casadi as ca
import numpy as np

from benchbench.conformance.checks.initial_value import (
    Transcribed,
    one_phase,
    scenario_of,
    transcribe,
)  # fmt: skip
from benchbench.conformance.checks.require import close, require
from benchbench.conformance.checks.states import at_rest
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import evaluate, gather
from benchbench.ocp.model import Model, input_bounds, output, output_bounds, output_box
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.touching import motors
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Phase
from benchbench.transcription.nodal import input_intervals

STATES = ("time", "configuration", "velocity")
THREE_PHASES = Grid(
    (
        Phase("approach", 3, 1e-4, 30, 0.3),
        Phase("contact", 2, 1e-4, 30, 0.1),
        Phase("leave", 4, 1e-4, 30, 0.6),
    )
)


def check_reading(dynamics: Dynamics, model: Model) -> None:
    """Decode after encode, and the node view, on one and on three phases."""
    for grid in (one_phase(6, 0.9), THREE_PHASES):
        transcribed = transcribe(dynamics, model, grid)
        plan = _random_plan(transcribed)
        again = transcribed.decode(transcribed.encode(plan))
        exactly = STATES if plan.interpolation == "bezier" else (*STATES, "inputs")
        for what in exactly:
            close(getattr(again, what), getattr(plan, what), 1e-12, f"{what} after encode and decode")
        _check_node_view(transcribed)


def _random_plan(transcribed: Transcribed) -> Plan:
    draw = np.random.default_rng(5)
    plan = transcribed.decode(transcribed.mpcc.guess)
    parts = {k: getattr(plan, k) for k in ("configuration", "velocity", "inputs")}
    return replace(plan, **{k: part + draw.uniform(-0.2, 0.2, part.shape) for k, part in parts.items()})


def _check_node_view(transcribed: Transcribed) -> None:
    mpcc, trajectory = transcribed.mpcc, transcribed.trajectory
    nodes = range(trajectory.grid.intervals)
    x = transcribed.encode(_random_plan(transcribed))
    plan, node = transcribed.decode(x), trajectory.node
    index = np.concatenate(
        [slot.index + mpcc.offsets[slot.variable] for slot in trajectory.slots(nodes)], axis=1
    )
    view = ca.Function("view", [node.z, node.p], [node.time, node.configuration, node.velocity])
    time, q, v = (
        np.asarray(out).T for out in view.map(len(nodes))(x[index].T, trajectory.parameters(nodes).T)
    )
    close(time[:, 0], plan.time[:-1], 1e-12, "time of the node view against decode")
    close(q, plan.configuration[:-1], 1e-12, "configuration of the node view against decode")
    close(v, plan.velocity[:-1], 1e-12, "velocity of the node view against decode")


def check_limits(dynamics: Dynamics, model: Model) -> None:
    """A flight at rest keeps everything; passing any one limit at any one node is noticed."""
    first, rest = model.configuration.names[0], at_rest(model)
    fastest = next(
        name
        for of in (model.velocity, output_box(model))
        for name, top in zip(of.names, of.upper, strict=True)
        if np.isfinite(top)
    )
    scenario = scenario_of(
        model, workspace={first: (rest[0] - 0.5, rest[0] + 0.5)}, rate_margin={fastest: 0.1}, travel_time=(0.01, 30.0),
    )  # fmt: skip
    for grid in (Grid((Phase("flight", 6, 0.01, 30.0, 0.05),)), THREE_PHASES):
        transcribed = transcribe(dynamics, model, grid, scenario)
        still = transcribed.decode(transcribed.encode(_at_rest_for(transcribed, model, 0.05)))
        _expect(transcribed, still, False, "a flight at rest")
        for seconds in (0.009, 31.0):
            _expect(transcribed, _at_rest_for(transcribed, model, seconds), True, f"a flight of {seconds} s")
        boxes = _boxes(transcribed, model, scenario, still)
        for what, box in boxes.items():
            for row, i, limit, inwards, name in _limits(box, getattr(still, what)):
                if what == "inputs" or 0 < row < len(still.time) - 1:
                    _expect(
                        transcribed,
                        _moved(still, what, row, i, limit + 0.01 * inwards),
                        False,
                        f"{name} inside",
                    )
                _expect(
                    transcribed,
                    _moved(still, what, row, i, limit - 0.01 * inwards),
                    True,
                    f"{what} {name} passed",
                )
        for row in (0, -1):
            _expect(
                transcribed,
                _moved(still, "configuration", row, 0, rest[0] + 0.01),
                True,
                "start or end moved",
            )
            _expect(transcribed, _moved(still, "velocity", row, 0, 0.01), True, "start or end not at rest")


def check_outputs(dynamics: Dynamics, model: Model) -> None:
    """A velocity that brings one limited output above or below its limit, at any node but the first, is noticed."""
    transcribed = transcribe(dynamics, model, one_phase(6, 0.5))
    q, v = (ca.SX.sym(k, len(of.names)) for k, of in (("q", model.configuration), ("v", model.velocity)))
    slope = ca.Function("slope", [q, v], [ca.jacobian(output(model, q, v), v)])
    slopes = np.asarray(slope(at_rest(model), np.zeros(v.shape[0])))
    towards = np.linalg.pinv(slopes) if len(slopes) else np.zeros((v.shape[0], 0))
    still = _at_rest_for(transcribed, model, 0.5)
    lower, upper = output_bounds(model, scenario_of(model).flown(model, len(still.time)))
    for i, node, share in product(range(len(slopes)), (1, 3, 5), (0.9, 1.01)):
        for limit in (lower[node, i], upper[node, i]):
            if np.isfinite(limit) and slopes[i].any():
                velocity = still.velocity.copy()
                velocity[node] = share * limit * towards[:, i]
                plan = replace(still, velocity=velocity)
                _expect(
                    transcribed, plan, share > 1, f"{share} times the limit of {output_box(model).names[i]}"
                )


def check_hover_ends(dynamics: Dynamics, model: Model) -> None:
    """`hover_ends` fixes the first and the last input, and only these."""
    transcribed = transcribe(dynamics, model, one_phase(6, 0.05), scenario_of(model, hover_ends=True))
    still = _at_rest_for(transcribed, model, 0.05)
    for row in range(len(still.inputs)):
        u = _moved(still, "inputs", row, 0, still.inputs[row, 0] + 0.01)
        ends = row in (0, len(still.inputs) - 1)
        _expect(transcribed, u, ends, f"input {row} of {len(still.inputs)} off hover")


def check_cost(dynamics: Dynamics, model: Model) -> None:
    """Travel time at hover; with held inputs off hover the effort adds exactly."""
    transcribed = transcribe(dynamics, model, THREE_PHASES, scenario_of(model, input_cost=0.01))
    still = _at_rest_for(transcribed, model, 0.7)
    close(_cost(transcribed, still), 0.7, 1e-12, "cost at hover against the travel time")
    off = replace(
        still, inputs=still.inputs + np.random.default_rng(6).uniform(-0.1, 0.1, still.inputs.shape)
    )
    found = _cost(transcribed, off)
    require(found > 0.7, "inputs off hover cost nothing")
    if still.interpolation == "hold":
        effort = np.diff(still.time) @ np.sum((off.inputs - model.hover())[:, motors(model)] ** 2, axis=1)
        close(found, 0.7 + 0.01 * effort, 1e-12, "cost off hover against t_N + c_u sum h |u - u_ref|^2")


def check_blocks(dynamics: Dynamics, model: Model) -> None:
    """Shapes of blocks, and every unknown is used somewhere."""
    mpcc = transcribe(dynamics, model, THREE_PHASES).mpcc
    used = np.zeros(mpcc.size, bool)
    for block in (*mpcc.constraints, *mpcc.costs):
        index = gather(block, mpcc.offsets)
        sizes = (block.function.size1_in(0), block.function.size1_in(1), block.function.size1_out(0))
        shapes = (index.shape, block.parameters.shape, block.lower.shape)
        wanted = tuple((block.instances, size) for size in sizes)
        require(shapes == wanted, f"block {block.name}: slots, parameters, bounds are {shapes}, not {wanted}")
        used[index.ravel()] = True
    require(np.all(used), f"{np.sum(~used)} unknowns are in no constraint and no cost")


NamedBounds = tuple[tuple[str, ...], Array, Array]
"""Names (n,), lower and upper limits (rows, n)."""


def _boxes(transcribed: Transcribed, model: Model, scenario: Scenario, still: Plan) -> dict[str, NamedBounds]:
    """Limits of each row of a plan; those of curved inputs are left out."""
    grid = transcribed.trajectory.grid
    flown = scenario.flown(model, len(still.time))
    q = scenario.limits(model)
    everywhere = [np.tile(b, (len(still.time), 1)) for b in (q.lower, q.upper)]
    found: dict[str, NamedBounds] = {
        "configuration": (q.names, everywhere[0], everywhere[1]),
        "velocity": (model.velocity.names, *scenario.planned_rates_at(model, flown)),
    }
    if still.interpolation != "bezier":
        found["inputs"] = (
            model.inputs.names,
            *input_bounds(model, flown[input_intervals(grid, len(still.inputs))]),
        )
    return found


def _limits(box: NamedBounds, values: Array) -> Iterator[tuple[int, int, float, float, str]]:
    """Every finite limit in five rows: row, column, limit, a step inwards, name."""
    names, lower, upper = box
    for row in (0, 1, len(values) // 2, len(values) - 2, len(values) - 1):
        for i, name in enumerate(names):
            low, high = lower[row, i], upper[row, i]
            for limit, other in ((low, high), (high, low)):
                if np.isfinite(limit):
                    inwards = np.clip(other - limit, -1.0, 1.0)
                    yield row, i, limit, inwards, f"{name} at row {row}"


def _at_rest_for(transcribed: Transcribed, model: Model, seconds: float) -> Plan:
    plan = transcribed.decode(transcribed.mpcc.guess)
    rest = np.tile(at_rest(model), (len(plan.time), 1))
    return replace(
        plan, time=plan.time * seconds / plan.travel_time, configuration=rest, velocity=0 * plan.velocity,
        inputs=np.tile(model.hover(), (len(plan.inputs), 1)),
    )  # fmt: skip


def _moved(plan: Plan, what: str, row: int, column: int, value: float) -> Plan:
    values = getattr(plan, what).copy()
    values[row, column] = value
    return replace(plan, **{what: values})


def _expect(transcribed: Transcribed, plan: Plan, broken: bool, what: str) -> None:
    """Fail unless bounds and inequality rows say `broken`."""
    violation = transcribed.limits.violation(transcribed.encode(plan))
    require(
        (violation > 1e-7) == broken, f"{what}: {'not noticed' if broken else f'violation {violation:.1e}'}"
    )


def _cost(transcribed: Transcribed, plan: Plan) -> float:
    x = transcribed.encode(plan)
    return float(sum(np.sum(evaluate(block, transcribed.mpcc, x)) for block in transcribed.mpcc.costs))


CHECKS = (check_reading, check_limits, check_outputs, check_hover_ends, check_cost, check_blocks)
