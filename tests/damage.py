"""A catalogue of damaged plans: what may be wrong with a plan, each as a function from a good one to a bad one.

Sizes are beyond the declared tolerances (conf/certificate/task.yaml), most of them by little.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.plan import Plan

Damage = Callable[[Plan], Plan]
METRES, ANGLE, SPEED, RATE = 0.012, 0.05, 0.03, 0.13
"""Offsets of one node in m, rad, m/s, rad/s: two to three times what an interval may be wrong by, or what holds a contact."""
SIZES = {"m": METRES, "rad": ANGLE, "m/s": SPEED, "rad/s": RATE, "1": 0.03}


def of_states(plan: Plan) -> Iterator[tuple[str, Damage]]:
    """Each component of the state: at one node, at the last but one, at every node away from contacts and ends."""
    for field, names, units in (
        ("configuration", plan.coordinate_names, plan.coordinate_units),
        ("velocity", plan.velocity_names, plan.velocity_units),
    ):
        for i, (name, unit) in enumerate(zip(names, units, strict=True)):
            size = SIZES[unit]
            yield (
                f"{field} {name} at one node",
                lambda p, f=field, i=i, s=size: _at(p, f, i, [_free(p)[3]], s),
            )
            yield (
                f"{field} {name} near the end",
                lambda p, f=field, i=i, s=size: _at(p, f, i, [p.intervals - 1], -s),
            )
            if field == "velocity":
                yield (
                    f"{field} {name} at all free nodes",
                    lambda p, f=field, i=i, s=size: _at(p, f, i, _free(p), s),
                )
            yield f"{field} {name} at the start", lambda p, f=field, i=i, s=size: _at(p, f, i, [0], s / 10)
            yield f"{field} {name} is no number", lambda p, f=field, i=i: _at(p, f, i, [_free(p)[5]], np.nan)


def of_inputs(plan: Plan) -> Iterator[tuple[str, Damage]]:
    """Each input: all of it, one row of it, beyond its limits, no number."""
    for i, name in enumerate(plan.input_names):
        yield f"input {name} a little stronger", lambda p, i=i: _inputs(p, i, slice(None), 1.04, 0.05)
        yield (
            f"input {name} of a quarter",
            lambda p, i=i: _inputs(p, i, slice(0, len(p.inputs) // 4), 0.9, -0.1),
        )
        yield f"input {name} beyond its limits", lambda p, i=i: _inputs(p, i, 3, 1.0, 10.0)
        yield f"input {name} is infinite", lambda p, i=i: _inputs(p, i, 2, 1.0, np.inf)
    yield "inputs one row late", lambda p: replace(p, inputs=np.roll(p.inputs, 4, axis=0))
    yield "inputs swapped", lambda p: replace(p, inputs=p.inputs[:, [1, 0, *range(2, len(p.input_names))]])
    yield "inputs of nothing", lambda p: replace(p, inputs=0 * p.inputs)


def of_time(plan: Plan) -> Iterator[tuple[str, Damage]]:
    """Scaled, moved, jumping, not increasing, no number."""
    yield "time shorter", lambda p: replace(p, time=p.time * 0.97)
    yield "time longer", lambda p: replace(p, time=p.time * 1.03)
    yield "time starts late", lambda p: replace(p, time=p.time + 1.0)
    yield "time starts early", lambda p: replace(p, time=p.time - 0.5)
    yield (
        "one interval longer",
        lambda p: replace(p, time=p.time + np.where(np.arange(len(p.time)) > 7, 0.02, 0.0)),
    )
    yield "time runs back", lambda p: replace(p, time=_moved(p.time, 9, -3.0))
    yield "time stands still", lambda p: replace(p, time=_moved(p.time, 9, p.time[8] - p.time[9]))
    yield "time is no number", lambda p: replace(p, time=_moved(p.time, 4, np.nan))


def of_claims(plan: Plan) -> Iterator[tuple[str, Damage]]:
    """Contact claimed where there is none, in fractions, not at all, everywhere."""
    first = int(np.argmax(plan.progress > 0.5))
    yield "claims earlier", lambda p: replace(p, progress=np.roll(p.progress, -6))
    yield "claims later", lambda p: replace(p, progress=np.roll(p.progress, 6))
    yield "claims none", lambda p: replace(p, progress=0 * p.progress)
    yield "claims everywhere", lambda p: replace(p, progress=0 * p.progress + 1.0)
    yield "claims a fraction elsewhere", lambda p: replace(p, progress=_moved(p.progress, first - 9, 0.02))
    yield (
        "claims hidden in all nodes",
        lambda p: replace(p, progress=p.progress * 0 + p.progress.sum() / len(p.progress)),
    )
    yield "claims half of it", lambda p: replace(p, progress=p.progress / 2)
    yield (
        "claims one node",
        lambda p: replace(p, progress=np.where(np.arange(len(p.progress)) == first, 1.0, 0.0)),
    )
    yield "claims a number that is none", lambda p: replace(p, progress=_moved(p.progress, first, np.nan))
    yield "claims less than nothing", lambda p: replace(p, progress=-p.progress)


def of_shape(plan: Plan) -> Iterator[tuple[str, Damage]]:
    """The whole flight elsewhere, the wrong way round, cut off, stretched."""
    yield (
        "elsewhere",
        lambda p: replace(
            p, configuration=p.configuration + 0.002 * (np.arange(p.configuration.shape[1]) == 0)
        ),
    )
    yield "backwards", lambda p: replace(p, configuration=p.configuration[::-1], velocity=-p.velocity[::-1])
    yield "cut off", lambda p: _cut(p, p.intervals - 6)
    yield "velocities of rest", lambda p: replace(p, velocity=0 * p.velocity)
    yield "velocities doubled", lambda p: replace(p, velocity=2 * p.velocity)
    yield "every other node", lambda p: _thinned(p)
    yield "smoothed", lambda p: replace(p, configuration=_smooth(p.configuration))
    yield "rounded to centimetres", lambda p: replace(p, configuration=np.round(p.configuration, 2))


def jump_at(plan: Plan, node: int) -> Plan:
    """Two flights joined: from a node on everything moves, and turns, 3 % slower than what came before arrives with."""
    later = np.arange(len(plan.time)) >= node
    return replace(plan, velocity=np.where(later[:, None], 0.97 * plan.velocity, plan.velocity))


def _free(plan: Plan) -> Array:
    """Nodes that are neither ends nor within two nodes of a claimed contact."""
    near = np.convolve(plan.progress_by_stop.max(axis=1) > 0, np.ones(5), "same") > 0
    near[[0, 1, -2, -1]] = True
    return np.flatnonzero(~near)


def _at(plan: Plan, field: str, column: int, nodes: object, offset: float) -> Plan:
    values = getattr(plan, field).copy()
    values[nodes, column] += offset
    return replace(plan, **{field: values})


def _inputs(plan: Plan, column: int, rows: slice | int, factor: float, offset: float) -> Plan:
    inputs = plan.inputs.copy()
    inputs[rows, column] = inputs[rows, column] * factor + offset
    return replace(plan, inputs=inputs)


def _moved(values: Array, at: int, by: float) -> Array:
    changed = values.copy()
    changed[at] += by
    return changed


def _cut(plan: Plan, intervals: int) -> Plan:
    nodes, rows = intervals + 1, len(plan.inputs) * intervals // plan.intervals
    rows += plan.interpolation == "linear"
    return replace(
        plan, time=plan.time[:nodes], configuration=plan.configuration[:nodes], velocity=plan.velocity[:nodes],
        inputs=plan.inputs[:rows], progress=plan.progress[:nodes],
    )  # fmt: skip


def _thinned(plan: Plan) -> Plan:
    """Every other node, each pair of held inputs by its mean, as a careless export does."""
    keep = slice(None, None, 2)
    inputs = (plan.inputs[0::2] + plan.inputs[1::2]) / 2
    return replace(
        plan, time=plan.time[keep], configuration=plan.configuration[keep], velocity=plan.velocity[keep], inputs=inputs,
        progress=plan.progress[keep],
    )  # fmt: skip


def _smooth(values: Array) -> Array:
    inner = (values[:-2] + values[1:-1] + values[2:]) / 3
    return np.vstack([values[:1], inner, values[-1:]])
