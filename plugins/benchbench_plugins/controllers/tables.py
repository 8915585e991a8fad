"""The reference on the grid of a controller, made consistent with the controller's own discrete model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from benchbench.flight.reference import Reference, entry, matrices, tip
from benchbench.flight.statics import mixer
from benchbench.ground.arrays import Array, Index
from benchbench.ocp.airframe import Airframe
from benchbench_plugins.controllers.centred import aside
from benchbench_plugins.controllers.prediction import STATES, stage

GRID = 0.01
"""s, of the tables; commands and stages begin on it."""


def _on_grid(step: float) -> float:
    if abs(step / GRID - round(step / GRID)) > 1e-9:
        raise ValueError(f"a stage is a multiple of {GRID:g} s")
    return step


Stage = Annotated[float, Field(ge=GRID, le=1, allow_inf_nan=False), AfterValidator(_on_grid)]
"""s, of one stage of a horizon."""
Ahead = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
"""s by which something is told or predicted before it works."""
NEAR = 0.1
"""s before the plan comes within the magnet's reach, from which on the end effector's velocity counts: a flight may be there sooner."""


@dataclass(frozen=True)
class Tables:
    """Rows every GRID s from the reference's first time on.

    state    (n, 10), aside of the reference; inputs (n, 4): what leads from each state of the reference to the one a stage later,
             mean over that stage
    offset   (n, 10): what the model misses in doing so, the arm's coupling acceleration above all; added to each step
    error    (n, 3, 4): attitude error 2 vec(q_r* (x) q) as a matrix on q
    arm      (n,) rad
    lever    (n, 3, 3) from body rates to the end effector's velocity, world, while the ball is near; zeros elsewhere
    coupling (m, 3) m/s^2 every `Reference.step`: acceleration of the reference that the model's thrust does not give
    wrench   (m, 4) thrust N and body torques N m of the plan, every `Reference.step`
    tip      (m, 3) m/s^2 acceleration of the end effector, gravity taken off, every `Reference.step`
    apart    (m, 3) m/s^2, which a payload at the tip adds to the coupling, times its share of the whole mass;
             stage_apart (n, 3) its mean over a stage
    """

    start: float
    state: Array
    inputs: Array
    offset: Array
    error: Array
    arm: Array
    lever: Array
    coupling: Array
    wrench: Array
    tip: Array
    apart: Array
    stage_apart: Array

    def row(self, time: float) -> int:
        """Return the row of a time."""
        return max(round((time - self.start) / GRID), 0)


def tables(reference: Reference, airframe: Airframe, step: float, share: float = 0.0) -> Tables:
    """Make them for stages of `step` s, with a share of the room beside the ball as `aside` has it."""
    each, span = round(GRID / reference.step), round(step / reference.step)
    rows = np.arange(0, len(reference.time), each)
    later = np.minimum(rows + span, len(reference.time) - 1)
    wrench = reference.inputs[:, :4] @ mixer(airframe).T
    mean = _means(wrench[:, :1] / airframe.total_mass, rows, later)
    q, after = reference.state[rows, 3:7], reference.state[later, 3:7]
    inputs = np.hstack([_rates(q, after) / step, mean])
    state = reference.state[:, [*range(7), 8, 9, 10]]
    model = stage(airframe.gravity, step).map(len(rows))
    ends = model(state[rows].T, inputs.T, np.zeros((STATES, len(rows))))[0].full().T
    up = matrices(reference.state[:, 3:7])[:, :, 2]
    thrust = up * wrench[:, :1] / airframe.total_mass - [0, 0, airframe.gravity]
    coupling = reference.acceleration - thrust
    pulled = np.gradient(
        tip(reference.state, airframe.arm_offset, airframe.arm_length)[1], reference.step, axis=0
    )
    apart = reference.acceleration - pulled - coupling
    place, speed = aside(reference, airframe, share)
    return Tables(
        float(reference.time[0]), state[rows] + np.hstack([place, 0 * state[:, 3:7], speed])[rows],
        inputs, state[later] - ends, _errors(q), reference.state[rows, 7],
        _levers(reference, airframe, rows), coupling, wrench, pulled + np.array([0.0, 0.0, airframe.gravity]), apart, _means(apart, rows, later),
    )  # fmt: skip


def _levers(reference: Reference, airframe: Airframe, rows: Index) -> Array:
    """-R [r]x with r from the vehicle's to the end effector's place in the body; zeros but from `NEAR` before the reach to the window's end."""
    state = reference.state[rows]
    arm, flat = state[:, 7], np.zeros(len(rows))
    x = airframe.arm_length * np.cos(arm)
    z = -airframe.arm_offset - airframe.arm_length * np.sin(arm)
    across = np.moveaxis(np.array([[flat, z, flat], [-z, flat, x], [flat, -x, flat]]), -1, 0)
    begin = entry(reference, airframe.arm_offset, airframe.arm_length) - NEAR
    counts = (reference.time >= begin) & (reference.time <= reference.window[1])
    return np.where(counts[rows, None, None], matrices(state[:, 3:7]) @ across, 0.0)


def _means(values: Array, rows: Index, later: Index) -> Array:
    """Means of values (m, k) from each row up to the later one, (n, k); the row itself at the end."""
    total = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, axis=0)])
    until = np.maximum(later, rows + 1)
    return np.asarray((total[until] - total[rows]) / (until - rows)[:, None])


def _rates(q: Array, after: Array) -> Array:
    """Constant rates (n, 3) that turn q into `after` in unit time."""
    vector = np.einsum("nij,nj->ni", _errors(q), after) / 2
    size = np.linalg.norm(vector, axis=1)
    angle = 2 * np.arcsin(np.minimum(size, 1.0))
    return vector * np.where(size > 1e-9, angle / np.maximum(size, 1e-9), 2.0)[:, None]


def _errors(q: Array) -> Array:
    w, x, y, z = q.T
    rows = [[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]]
    return 2 * np.moveaxis(np.array(rows), -1, 0)
