"""Random states of a model within its limits, a configuration at rest, and its symbols as functions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.optimize import least_squares

from benchbench.conformance.checks.require import require
from benchbench.ground.arrays import Array
from benchbench.ocp.mechanics import acceleration, mass_matrix
from benchbench.ocp.model import Coordinates, LagrangianModel, Model, space
from benchbench.ocp.touching import TouchingModel

WIDE = 2.0
"""Where a coordinate has no limit, it is drawn from [-WIDE, WIDE]."""


@dataclass(frozen=True)
class Symbols:
    """A model's expressions as functions of q, v, u."""

    acceleration: ca.Function
    rate: ca.Function
    tool: ca.Function
    nose: ca.Function
    normalised: ca.Function


@dataclass(frozen=True)
class Energies:
    """What only a model with a Lagrangian has."""

    lagrangian: ca.Function
    energy: ca.Function
    mass: ca.Function
    force: ca.Function


def symbols(model: Model) -> Symbols:
    """Return the functions; tool gives position and velocity."""
    q, v, u = _arguments(model)
    tool, lives = model.tool(q), space(model)
    return Symbols(
        ca.Function("acceleration", [q, v, u], [acceleration(model, q, v, u)]),
        ca.Function("rate", [q, v], [lives.kinematics(q, v)]),
        ca.Function("tool", [q, v], [tool, ca.jtimes(tool, q, lives.kinematics(q, v))]),
        ca.Function("nose", [q], [model.nose(q)]),
        _normalising(model),
    )


def energies(model: LagrangianModel) -> Energies:
    """Return the functions; energy is v . dL/dv - L."""
    q, v, u = _arguments(model)
    lagrangian = model.lagrangian(q, v)
    energy = ca.dot(v, ca.gradient(lagrangian, v)) - lagrangian
    return Energies(
        ca.Function("lagrangian", [q, v], [lagrangian]),
        ca.Function("energy", [q, v], [energy]),
        ca.Function("mass", [q, v], [mass_matrix(model, q, v)]),
        ca.Function("force", [q, v, u], [model.force(q, v, u)]),
    )


def normalised(model: Model, q: Array) -> Array:
    """Configurations (n, n_q) moved to where they live."""
    return np.asarray(_normalising(model)(q.T)).T


def _normalising(model: Model) -> ca.Function:
    q, _, _ = _arguments(model)
    return ca.Function("normalised", [q], [space(model).normalised(q)])


def _arguments(model: Model) -> tuple[ca.SX, ca.SX, ca.SX]:
    parts = {"q": model.configuration, "v": model.velocity, "u": model.inputs}
    q, v, u = (ca.SX.sym(name, len(of.names)) for name, of in parts.items())
    return q, v, u


def limited(of: Coordinates) -> tuple[Array, Array]:
    """Limits (n,), and WIDE where there are none."""
    low = np.where(np.isfinite(of.lower), of.lower, np.minimum(-WIDE, of.upper - 2 * WIDE))
    return low, np.where(np.isfinite(of.upper), of.upper, np.maximum(WIDE, low + 2 * WIDE))


def random_states(model: Model, count: int, seed: int = 0) -> tuple[Array, Array, Array]:
    """Return q (count, n_q), v (count, n_v) and u (count, n_u), uniform within the limits, q normalised.

    Forces of contact are those of q and v, as complementarity says.
    """
    draw = np.random.default_rng(seed)
    q, v, u = (
        draw.uniform(*limited(of), (count, len(of.names)))
        for of in (model.configuration, model.velocity, model.inputs)
    )
    q = normalised(model, q)
    return q, v, touched(model, q, v, u) if isinstance(model, TouchingModel) else u


def touched(model: TouchingModel, q: Array, v: Array, u: Array) -> Array:
    """Return inputs u (n, n_u) with the forces of contact at which the model's pairs vanish for q (n, n_q), v (n, n_v)."""
    symbols = _arguments(model)
    pair = ca.Function("pair", [*symbols], [*model.contact(*symbols)])
    forces = [model.inputs.names.index(name) for name in model.touches]
    return np.array([_touched(pair, forces, *state) for state in zip(q, v, u, strict=True)])


def _touched(pair: ca.Function, forces: list[int], q: Array, v: Array, u: Array) -> Array:
    def pushed(by: Array) -> Array:
        inputs = u.copy()
        inputs[forces] = by
        return inputs

    def fischer_burmeister(by: Array) -> Array:
        g, h = (np.asarray(one).ravel() for one in pair(q, v, pushed(by)))
        return np.asarray(g + h - np.hypot(g, h))

    found = least_squares(fischer_burmeister, np.ones(len(forces)), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    require(found.cost < 1e-20, f"no forces of contact solve the pairs at q = {q}")
    return pushed(found.x)


def at_rest(model: Model) -> Array:
    """Return the configuration (n_q,) near the middle of the limits that hover() holds at rest.

    What has no limits stays near its value in `Space.origin`. Found once per model, every check asks for it.
    """
    if id(model) not in _RESTS:
        _RESTS[id(model)] = (model, _at_rest(model))
    return _RESTS[id(model)][1].copy()


_RESTS: dict[int, tuple[Model, Array]] = {}
"""By identity, as a model need not be hashable; the model is kept, so that no other one gets its identity."""


def _at_rest(model: Model) -> Array:
    box = model.configuration
    bounded = np.isfinite(box.lower) & np.isfinite(box.upper)
    low, high = limited(box)
    plant, still = model.plant(), np.zeros(len(model.velocity.names))
    first = np.where(bounded, (low + high) / 2, space(model).origin())

    def falling(q: Array) -> Array:
        return plant.acceleration(q, still, model.hover())

    found = least_squares(falling, first, bounds=(low, high), xtol=1e-15)
    require(
        np.max(np.abs(found.fun)) < 1e-9,
        f"no configuration near the middle of the limits is at rest under hover(): acceleration {found.fun}",
    )
    return np.asarray(normalised(model, found.x[None])[0])
