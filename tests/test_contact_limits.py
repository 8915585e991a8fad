"""The planner's condition and the certificate's gap mean one limit, for every limit, speed and state that a user may give."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from flights import REST, table_one

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Contact, Target
from benchbench.ocp.node import Node
from benchbench_plugins.contacts.approach import Approach
from benchbench_plugins.contacts.floor import Floor
from benchbench_plugins.contacts.heading import SLOW, Heading
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity

TOLERANCE = 1e-7
"""A tenth of what the certificate grants at a node."""
LIMITS = (1e-9, 1e-7, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 1.0)
SPEEDS = (0.0, 1e-12, 1e-9, 0.5 * SLOW, 1.01 * SLOW, 3e-5, 1e-4, 1e-3, 0.01, 0.03, 1.0, 30.0)
BESIDE = (-0.5, -1e-3, 0.0, 1e-3, 1.0)
"""Gaps beside a limit, as shares of it, and in its unit `TOLERANCE` beside it."""
MODEL = table_one()
MODEL_PLANT = MODEL.plant()


def states(count: int) -> tuple[Array, Array]:
    """That many states in flight, (count, 7) each: anywhere, tilted and turned, the arm bent, in motion."""
    random = np.random.default_rng(15)
    spread = np.array([3.0, 3.0, 1.0, 0.7, 0.7, 3.0, 0.5])
    q = REST + spread * random.uniform(-1, 1, (count, 7))
    return q, random.normal(size=(count, 7)) * np.array([1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0])


def unit(count: int) -> Array:
    """Directions in space, (count, 3)."""
    random = np.random.default_rng(4).normal(size=(count, 3))
    return random / np.linalg.norm(random, axis=1)[:, None]


def targets(contact: Contact, gap: Array, speed: Array, q: Array, v: Array) -> tuple[Array, Array]:
    """Positions and velocities of targets for which the gaps are those wanted."""
    (tool, moving), way = MODEL_PLANT.tool(q, v), unit(len(q))
    if isinstance(contact, Position):
        return tool + gap[:, None] * way, speed[:, None] * way
    if isinstance(contact, Floor):
        return tool + np.stack([0 * gap, 0 * gap, gap], axis=1), speed[:, None] * way
    if isinstance(contact, Velocity):
        return tool, moving + gap[:, None] * way
    if isinstance(contact, Approach):  # above the ball, by as much as another direction says
        clearance = np.abs(way[:, 2])
        faster = np.hypot(1.0, contact.slope * clearance / contact.limit)
        return tool - np.stack([0 * gap, 0 * gap, clearance], axis=1), moving + (gap * faster)[:, None] * way
    nose = MODEL_PLANT.nose(q)
    angle = np.arctan2(nose[:, 1], nose[:, 0]) + gap * np.where(np.arange(len(q)) % 2, 1, -1)
    return tool, np.stack([speed * np.cos(angle), speed * np.sin(angle), 0.3 + 0 * speed], axis=1)


def planned(contact: Contact, *numbers: Array) -> Array:
    """H of the planner at states and targets, (n,)."""
    symbols = [ca.SX.sym(k, n) for k, n in (("q", 7), ("v", 7), ("p", 3), ("w", 3))]
    node = Node(ca.vertcat(*symbols[:2]), ca.SX(0, 1), ca.SX.sym("t"), symbols[0], symbols[1])
    h = ca.Function("h", symbols, [contact.condition(MODEL, node, Target(*symbols[2:])).h])
    return np.asarray(h.map(len(numbers[0]))(*(part.T for part in numbers))).ravel()


@pytest.mark.parametrize("kind", [Position, Velocity, Heading, Floor, Approach])
@pytest.mark.parametrize("limit", LIMITS)
def test_what_the_planner_allows_the_certificate_does(kind: type[Contact], limit: float) -> None:
    gaps = np.array(
        [*(limit * (1 + share) for share in BESIDE), limit + 2 * TOLERANCE, limit - 2 * TOLERANCE]
    )
    gap, speed = (part.ravel() for part in np.meshgrid(gaps[gaps >= 0], SPEEDS))
    q, v = states(len(gap))
    contact = kind(limit)  # type: ignore[call-arg]
    p, w = targets(contact, gap, speed, q, v)
    h, measured = planned(contact, q, v, p, w), contact.gap(MODEL_PLANT, q, v, p, w)
    moving = speed > SLOW if kind is Heading else np.full(len(gap), True)
    np.testing.assert_allclose(measured[moving], gap[moving], atol=1e-12, rtol=0)
    assert np.all(np.isfinite(h))
    assert np.all(measured[h <= 0] <= limit + TOLERANCE), "planned, and refused"
    assert np.all(h[measured <= limit - TOLERANCE][moving[measured <= limit - TOLERANCE]] <= 0), (
        "refused, and allowed"
    )
    assert np.all(h[(measured > limit + TOLERANCE)] > 0)
    assert np.all(h[(speed == 0) & ~moving] == -1), "what stands has no direction"
