"""What is required of an `AgileModel`: nothing that its plant flies comes farther than it says, and no time brings less way."""

from __future__ import annotations

import numpy as np

from benchbench.conformance.checks.require import require
from benchbench.conformance.checks.states import at_rest
from benchbench.ground.arrays import Array, Flags
from benchbench.ocp.model import AgileModel, Model, output_box

STEP, STEPS, FLIGHTS = 1e-3, 300, 60
"""s, and counts: inputs at their limits, held for 10 to 300 ms, from rest, until a limit of the vehicle is broken."""
AXES = ("x", "y", "z")


def check_way_from_rest(model: Model) -> None:
    """Flights of the plant stay inside, the way grows with time, begins at none, and is no longer in reversed order."""
    if not isinstance(model, AgileModel):
        return
    rest = at_rest(model)
    time = np.linspace(0.0, STEP * STEPS, STEPS + 1)
    back, ahead = model.way_from_rest(rest, time)
    for way in (back, ahead):
        require(way.shape == (len(time), 3), f"way_from_rest has shape {way.shape}")
        require(bool(np.all(np.diff(way, axis=0) >= -1e-12)), "the way from rest gets shorter with time")
        require(bool(np.all(way >= 0.0)), "the way from rest is negative")
    reverse = model.way_from_rest(rest, time[::-1])
    require(bool(np.array_equal(reverse[1][::-1], ahead)), "the way from rest depends on the other times")
    place, inside = _flights(model, rest)
    for axis in range(3):
        moved = place[..., axis] - place[:1, :1, axis]
        beyond = np.where(inside, np.maximum(moved - ahead[:, axis], -moved - back[:, axis]), 0.0)
        worst = float(np.max(beyond))
        require(
            worst <= 1e-9,
            f"a flight of the plant comes {worst:.2g} m farther along {AXES[axis]} than the way from rest",
        )
    require(model.level_yaw_acceleration > 0, "level_yaw_acceleration is not above 0")


def _flights(model: AgileModel, rest: Array) -> tuple[Array, Flags]:
    """Positions (flights, steps + 1, 3) and until when no limit is broken (flights, steps + 1)."""
    plant, draw = model.plant(), np.random.default_rng(11)
    low, high = model.inputs.lower, model.inputs.upper
    u = np.tile(model.hover(), (FLIGHTS, 1))
    change = np.zeros(FLIGHTS, int)
    q, v = np.tile(rest, (FLIGHTS, 1)), np.zeros((FLIGHTS, len(model.velocity.names)))
    index = [model.configuration.index(name) for name in AXES]
    place, inside = [q[:, index]], [np.ones(FLIGHTS, bool)]
    with np.errstate(all="ignore"):  # what has broken its limits may fly to infinity
        for step in range(STEPS):
            new = change <= step
            u = np.where(new[:, None], np.where(draw.random(u.shape) < 0.5, low, high), u)
            change = np.where(new, step + draw.integers(10, 300, FLIGHTS), change)
            middle_v = v + STEP / 2 * plant.acceleration(q, v, u)
            middle_q = q + STEP / 2 * plant.kinematics(q, v)
            q = q + STEP * plant.kinematics(middle_q, middle_v)
            v = v + STEP * plant.acceleration(middle_q, middle_v, u)
            place.append(q[:, index])
            inside.append(inside[-1] & _keeps(model, q, v))
    return np.stack(place, axis=1), np.stack(inside, axis=1)


def _keeps(model: AgileModel, q: Array, v: Array) -> Flags:
    """Whether all limits are kept, (flights,)."""
    said = ((model.configuration, q), (model.velocity, v), (output_box(model), model.plant().output(q, v)))
    return np.asarray(np.all([np.all((x >= of.lower) & (x <= of.upper), axis=1) for of, x in said], axis=0))
