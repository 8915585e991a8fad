"""Random states of a model within its limits, a configuration at rest, and its symbols as functions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.optimize import least_squares

from benchbench.conformance.checks.require import require
from benchbench.model import Coordinates, Model, mass_matrix
from benchbench.plan import Array

WIDE = 2.0
"""Where a coordinate has no limit, it is drawn from [-WIDE, WIDE]."""


@dataclass(frozen=True)
class Symbols:
    """A model's expressions as functions of q, v, u."""

    lagrangian: ca.Function
    energy: ca.Function
    mass: ca.Function
    force: ca.Function
    acceleration: ca.Function
    tool: ca.Function
    nose: ca.Function


def symbols(model: Model) -> Symbols:
    """Return the functions; energy is v . dL/dv - L."""
    n, m = len(model.configuration.names), len(model.inputs.names)
    q, v, u = ca.SX.sym("q", n), ca.SX.sym("v", n), ca.SX.sym("u", m)
    lagrangian, tool = model.lagrangian(q, v), model.tool(q)
    energy = ca.dot(v, ca.gradient(lagrangian, v)) - lagrangian
    return Symbols(
        ca.Function("lagrangian", [q, v], [lagrangian]),
        ca.Function("energy", [q, v], [energy]),
        ca.Function("mass", [q, v], [mass_matrix(model, q, v)]),
        ca.Function("force", [q, v, u], [model.force(q, v, u)]),
        ca.Function("acceleration", [q, v, u], [model.acceleration(q, v, u)]),
        ca.Function("tool", [q, v], [tool, ca.jtimes(tool, q, v)]),
        ca.Function("nose", [q], [model.nose(q)]),
    )


def limited(of: Coordinates) -> tuple[Array, Array]:
    """Limits (n,), and WIDE where there are none."""
    low = np.where(np.isfinite(of.lower), of.lower, np.minimum(-WIDE, of.upper - 2 * WIDE))
    return low, np.where(np.isfinite(of.upper), of.upper, np.maximum(WIDE, low + 2 * WIDE))


def random_states(model: Model, count: int, seed: int = 0) -> tuple[Array, Array, Array]:
    """Return q, v (count, n_q) and u (count, n_u), uniform within the limits."""
    draw = np.random.default_rng(seed)
    return tuple(  # type: ignore[return-value]
        draw.uniform(*limited(of), (count, len(of.names)))
        for of in (model.configuration, model.velocity, model.inputs)
    )


def at_rest(model: Model) -> Array:
    """Return the configuration (n_q,) nearest to the middle of the limits that hover() holds at rest."""
    low, high = (np.asarray(bound) for bound in limited(model.configuration))
    plant, still = model.plant(), np.zeros(len(low))

    def falling(q: Array) -> Array:
        return plant.acceleration(q, still, model.hover())

    found = least_squares(falling, (low + high) / 2, bounds=(low, high), xtol=1e-15)
    require(
        np.max(np.abs(found.fun)) < 1e-9,
        f"no configuration near the middle of the limits is at rest under hover(): acceleration {found.fun}",
    )
    return np.asarray(found.x)
