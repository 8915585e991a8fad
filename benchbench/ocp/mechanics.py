"""How a model moves: what follows from a Lagrangian and generalised forces, or what the model says itself."""

from __future__ import annotations

import casadi as ca

from benchbench.ocp.model import ExplicitModel, LagrangianModel, Model, space


def acceleration(model: Model, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
    """Return dv/dt, shape (n_v,): the model's own, else by the Euler-Lagrange equations (paper Eq. 13-14).

    Raises TypeError for a model that gives neither.
    """
    if isinstance(model, ExplicitModel):
        return model.acceleration(q, v, u)
    momentum, drift = momentum_drift(lagrangian_model(model), q, v)
    return ca.solve(ca.jacobian(momentum, v), momentum_rate(lagrangian_model(model), q, v, u) - drift)


def momentum_drift(model: LagrangianModel, q: ca.SX, v: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return p = dL/dv and the part of dp/dt that comes from dq/dt alone, each (n_v,)."""
    momentum = ca.gradient(model.lagrangian(q, v), v)
    return momentum, ca.jtimes(momentum, q, space(model).kinematics(q, v))


def momentum_rate(model: LagrangianModel, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
    """Return d/dt dL/dv, shape (n_v,): dL/dq + Q, and where v is not dq/dt the Boltzmann-Hamel terms.

    With dq/dt = K(q) v and v = P(q) dq/dt: K^T dL/dq + Q + K^T (A^T - A) dq/dt, A = d(P^T dL/dv)/dq
    (for body rates that is the momentum crossed with omega).
    """
    lives = space(model)
    lagrangian, rate = model.lagrangian(q, v), lives.kinematics(q, v)
    slope = ca.gradient(lagrangian, q)
    if lives.flat:
        return slope + model.force(q, v, u)
    other, fixed = ca.SX.sym("other", q.shape[0]), ca.SX.sym("momentum", v.shape[0])
    inverse = ca.substitute(ca.jacobian(lives.difference(q, other), other), other, q)
    curl = ca.jacobian(inverse.T @ fixed, q)
    twist = ca.substitute((curl.T - curl) @ rate, fixed, ca.gradient(lagrangian, v))
    return ca.jacobian(rate, v).T @ (slope + twist) + model.force(q, v, u)


def mass_matrix(model: LagrangianModel, q: ca.SX, v: ca.SX) -> ca.SX:
    """Return M(q) = d2L/dv2, shape (n_v, n_v)."""
    return ca.hessian(model.lagrangian(q, v), v)[0]


def lagrangian_model(model: Model) -> LagrangianModel:
    """Return the model; raises TypeError where it has no Lagrangian."""
    if not isinstance(model, LagrangianModel):
        raise TypeError(
            f"{type(model).__name__} gives neither acceleration nor Lagrangian that is needed here"
        )
    return model
