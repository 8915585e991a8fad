"""What is required of a contact, on any model.

meaning      h <= 0 exactly where the plant's gap is within `limit`, near the limit as well
scale        where `limit` is given, h = (gap / limit)^2 - 1, so that relaxations and margins find the gap in it
derivatives  h is differentiable: gradient equals finite differences, and gradient and Hessian are finite
             where the gap is 0, at rest, and for a target that stands still
shape        h (m,), a gap (n,) >= 0 in `unit`
reach        where the condition holds, the end effector is within `reach` of the target, if it says one
words        noun and aside, which sentences about its gap are made of
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from benchbench.conformance.checks.require import close, require
from benchbench.conformance.checks.states import random_states
from benchbench.ground.arrays import Array, Flags
from benchbench.ocp.contact import Condition, Contact, NoseContact, Target
from benchbench.ocp.model import Model
from benchbench.ocp.node import Node

REACH = 3.0
"""States are drawn with gaps of up to about this many limits."""


def check_meaning(contact: Contact, model: Model) -> None:
    """Sign of h against the gap through the plant; both signs must occur among the states tried."""
    states = near_states(contact, model, 400)
    value = _function(contact, model)
    h = np.max(np.asarray(value(*(x.T for x in states))), axis=0)
    gap = contact.gap(model.plant(), *states)
    require(
        gap.shape == (400,) and bool(np.all(gap >= 0)), f"gap must be (n,) and >= 0, has shape {gap.shape}"
    )
    inside = gap <= contact.limit
    clear = (np.abs(gap / contact.limit - 1) > 1e-6) & _means_something(contact, model, *states)
    share = float(np.mean(inside))
    require(
        0.02 < share < 0.98,
        f"{share:.0%} of the states near the limit are within it: limit and gap do not match",
    )
    wrong = clear & ((h <= 0) != inside)
    require(
        not np.any(wrong),
        f"h <= 0 and gap <= {contact.limit} disagree at {np.sum(wrong)} of 400 states, "
        f"for example gap {gap[np.argmax(wrong)]:.6g} where h = {h[np.argmax(wrong)]:.3g}",
    )


def check_boundary(contact: Contact, model: Model) -> None:
    """Within 1e-3, h is zero where the gap is at the limit; found by bisection between states."""
    states, plant = near_states(contact, model, 400, seed=1), model.plant()
    value = _function(contact, model)
    inside = contact.gap(plant, *states) <= contact.limit
    low, high = (np.hstack(states)[which] for which in (inside, ~inside))
    count = min(len(low), len(high), 40)
    cuts = np.cumsum([x.shape[1] for x in states])[:-1]
    a, b = low[:count], high[:count]
    for _ in range(60):
        middle = (a + b) / 2
        met = contact.gap(plant, *np.split(middle, cuts, axis=1)) <= contact.limit
        a, b = np.where(met[:, None], middle, a), np.where(met[:, None], b, middle)
    border = np.split(a, cuts, axis=1)
    clear = _means_something(contact, model, *border)
    require(np.sum(clear) >= 5, "too few states at the limit were found to judge")
    h = np.max(np.asarray(value(*(x.T for x in border))), axis=0)[clear]
    error = float(np.max(np.abs(h)))
    require(error <= 1e-3, f"h is {error:.1e} where the gap is at its limit")


def check_scale(contact: Contact, model: Model) -> None:
    """Where `limit` is given, h = (gap / limit)^2 - 1 up to 2 %: relaxations and margins take the gap back from h."""
    condition, *_ = _condition(contact, model)
    if condition.limit is None or condition.h.shape[0] != 1:
        return
    states = near_states(contact, model, 400, seed=4)
    h = np.asarray(_function(contact, model)(*(x.T for x in states))).ravel()
    gap = contact.gap(model.plant(), *states)
    near = (gap <= 1.5 * contact.limit) & _means_something(contact, model, *states)
    again = condition.limit[0] * np.sqrt(np.maximum(h[near] + 1, 0))
    error = float(np.max(np.abs(again - gap[near]))) / contact.limit
    require(error <= 0.02, f"limit * sqrt(h + 1) misses the gap by {error:.1%} of the limit")


def check_gradient(contact: Contact, model: Model) -> None:
    """Gradient of h by q, v and the target's state against central differences."""
    value, gradient, _ = _derivatives(contact, model)
    for state in np.hstack(near_states(contact, model, 10, seed=2)):
        steps = 1e-6 * np.eye(len(state))
        slope = np.hstack([np.asarray(value(state + s) - value(state - s)) / 2e-6 for s in steps])
        exact = np.asarray(gradient(state))
        scale = 1 + np.max(np.abs(exact))
        close(exact / scale, slope / scale, 1e-5, "gradient of h against finite differences")


def check_smoothness(contact: Contact, model: Model) -> None:
    """Value, gradient and Hessian are finite at the states that planners start from."""
    functions = _derivatives(contact, model)
    plant = model.plant()
    for q, v, _ in zip(*random_states(model, 5, seed=3), strict=True):
        for speed in (v, 0 * v):
            tip, way = plant.tool(q, speed)
            for velocity in (way, np.zeros(3), 0.1 * plant.nose(q)):
                state = np.concatenate([q, speed, tip, velocity])
                for function, what in zip(functions, ("h", "gradient", "Hessian"), strict=True):
                    finite = np.all(np.isfinite(np.asarray(function(state))))
                    require(bool(finite), f"{what} is not finite with gap 0, target velocity {velocity}")


def check_reach(contact: Contact, model: Model) -> None:
    """Where the gap is within the limit, the end effector is within `reach`; of a contact without one nothing is asked."""
    if contact.reach is None:
        return
    count, draw, plant = 400, np.random.default_rng(5), model.plant()
    q, v, _ = random_states(model, count, seed=5)
    tip, way = plant.tool(q, v)
    apart = draw.uniform(0, REACH * contact.reach, count)
    apart[: count // 2] *= draw.uniform(0, 1, count // 2)  # half of them nearer
    for drift in (0.0, REACH * contact.limit):
        moving = way + _directions(draw, count) * draw.uniform(0, 1, (count, 1)) * drift
        gap = contact.gap(plant, q, v, tip + apart[:, None] * _directions(draw, count), moving)
        inside = gap <= contact.limit
        require(
            bool(inside.any()) or drift > 0, "it holds at none of 400 states within three times its reach"
        )
        far = float(np.max(apart[inside], initial=0.0))
        require(
            far <= contact.reach * (1 + 1e-9),
            f"it holds {far:.6g} m apart, beyond its reach of {contact.reach:g} m",
        )


def check_words(contact: Contact, model: Model) -> None:
    """It says what its gap is called, and what follows a gap in a summary."""
    for name in ("noun", "aside", "unit"):
        said = getattr(contact, name, None)
        require(isinstance(said, str) and bool(said.strip()), f"{name} is {said!r}, expected a word or two")


def near_states(
    contact: Contact, model: Model, count: int, seed: int = 0
) -> tuple[Array, Array, Array, Array]:
    """Random q, v (n, n_q) and targets (n, 3) whose offset, relative velocity and heading are near the limit.

    Half of the targets move like the tool, half along the nose; each turned by up to REACH limits and shifted by up to
    REACH times what the contact reaches, its limit where it says no reach.
    """
    draw, plant = np.random.default_rng(seed), model.plant()
    q, v, _ = random_states(model, count, seed)
    tip, way = plant.tool(q, v)
    offset, drift = (
        _directions(draw, count) * draw.uniform(0, REACH * most, (count, 1))
        for most in (contact.reach or contact.limit, contact.limit)
    )
    turn = draw.uniform(-REACH, REACH, count) * min(contact.limit, 1.0)
    nose = plant.nose(q)
    along = np.stack([
        nose[:, 0] * np.cos(turn) - nose[:, 1] * np.sin(turn), nose[:, 0] * np.sin(turn) + nose[:, 1] * np.cos(turn),
        nose[:, 2],
    ], axis=-1) * draw.uniform(0.05, 1.0, (count, 1))  # fmt: skip
    follows = draw.uniform(size=(count, 1)) < 0.5
    return q, v, tip + offset, np.where(follows, way + drift, along)


def _means_something(
    contact: Contact, model: Model, q: Array, v: Array, position: Array, velocity: Array
) -> Flags:
    """Where a contact asks where the nose points, it and the target's way have a direction on the ground."""
    if not isinstance(contact, NoseContact):
        return np.ones(len(q), bool)
    nose = np.linalg.norm(model.plant().nose(q)[:, :2], axis=1)
    return np.asarray((nose > 0.5) & (np.linalg.norm(velocity[:, :2], axis=1) > 0.03))


def _directions(draw: np.random.Generator, count: int) -> Array:
    way = draw.normal(size=(count, 3))
    return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True))


def _condition(contact: Contact, model: Model) -> tuple[Condition, ca.SX, ca.SX, ca.SX, ca.SX]:
    sizes = {"q": len(model.configuration.names), "v": len(model.velocity.names), "p_T": 3, "v_T": 3}
    q, v, position, velocity = (ca.SX.sym(k, m) for k, m in sizes.items())
    node = Node(ca.vertcat(q, v), ca.SX.sym("p", 0), ca.SX.sym("t"), q, v)
    condition = contact.condition(model, node, Target(position, velocity))
    require(condition.h.shape[1] == 1, f"h has shape {condition.h.shape}, expected (m, 1)")
    return condition, q, v, position, velocity


def _function(contact: Contact, model: Model) -> ca.Function:
    """q, v, p_T, v_T -> h, for columns of states."""
    condition, *symbols = _condition(contact, model)
    return ca.Function("h", symbols, [condition.h])


def _derivatives(contact: Contact, model: Model) -> tuple[ca.Function, ca.Function, ca.Function]:
    """Stacked state -> h, dh, and all second derivatives."""
    condition, *symbols = _condition(contact, model)
    state = ca.vertcat(*symbols)
    first = ca.jacobian(condition.h, state)
    return tuple(  # type: ignore[return-value]
        ca.Function("derivative", [state], [e])
        for e in (condition.h, first, ca.jacobian(ca.vec(first), state))
    )


CHECKS = (
    check_meaning, check_boundary, check_scale, check_gradient, check_smoothness, check_reach, check_words,
)  # fmt: skip
