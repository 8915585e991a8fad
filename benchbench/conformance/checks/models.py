"""What is required of a model: a Lagrangian system whose symbols and whose independent plant say the same.

limits      equal lengths and names, lower <= upper, hover() within the input limits
motion      the symbols (by the Euler-Lagrange equations, where there is a Lagrangian) give the plant's dv/dt, dq/dt
manifold    normalised() changes nothing twice, and dq/dt keeps what it keeps; difference() inverts dq/dt, is odd and
            exact to second order; constraint() is zero on it
outputs     the symbols' further limited quantities are the plant's
With a Lagrangian (models without one pass):
Lagrangian  L = v^T M(q) v / 2 - V(q) with M symmetric positive definite
forces      Q . v is the power that the plant's energy gains in any direction v (virtual work)
Always:
geometry    tool() and nose() equal the plant's; tool velocity is its derivative; nose has length one
rest        hover() holds some configuration within the limits
plant       batched over leading axes
agility     where a model says how far it comes from rest, no flight of its plant comes farther (`checks.agility`)
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from benchbench.conformance.checks.agility import check_way_from_rest
from benchbench.conformance.checks.require import close, require
from benchbench.conformance.checks.states import at_rest, energies, limited, random_states, symbols
from benchbench.ground.arrays import Array
from benchbench.ocp.model import LagrangianModel, Model, Plant, output, output_bounds, output_box, space


def check_limits(model: Model) -> None:
    """Names, units and limits fit together."""
    for what in ("configuration", "velocity", "inputs"):
        of = getattr(model, what)
        n = len(of.names)
        shapes = {np.shape(of.lower), np.shape(of.upper), (len(of.units),)}
        require(shapes == {(n,)}, f"{what}: {n} names, but units and limits have shapes {shapes}")
        require(n > 0 and len(set(of.names)) == n, f"{what}: names {of.names} repeat or are missing")
        require(np.all(of.lower <= of.upper), f"{what}: a lower limit exceeds its upper limit or is NaN")
    inputs, hover = model.inputs, np.asarray(model.hover())
    require(hover.shape == inputs.lower.shape, f"hover() has shape {hover.shape}")
    require(np.all((hover >= inputs.lower) & (hover <= inputs.upper)), f"hover() = {hover} breaks the limits")


def check_mass_matrix(model: Model) -> None:
    """M(q) = d2L/dv2 is symmetric positive definite, and L = v^T M v / 2 + L(q, 0)."""
    if not isinstance(model, LagrangianModel):
        return
    of = energies(model)
    for q, v, _ in zip(*random_states(model, 20), strict=True):
        mass = np.asarray(of.mass(q, v))
        close(mass, mass.T, 1e-12, "mass matrix against its transpose")
        smallest = np.linalg.eigvalsh(mass)[0]
        require(
            smallest > 1e-12 * np.trace(mass), f"mass matrix has the eigenvalue {smallest:.2e} at q = {q}"
        )
        kinetic = float(of.lagrangian(q, v) - of.lagrangian(q, 0 * v))
        close(v @ mass @ v / 2, kinetic, 1e-10, "v^T M v / 2 against L(q, v) - L(q, 0)")


def check_acceleration(model: Model) -> None:
    """The symbols' dv/dt and dq/dt against the plant's."""
    of, states = symbols(model), random_states(model, 40)
    ours = [np.asarray(of.acceleration(*state)).ravel() for state in zip(*states, strict=True)]
    close(model.plant().acceleration(*states), ours, 1e-8, "the plant's acceleration against the symbols'")
    rates = [np.asarray(of.rate(*state)).ravel() for state in zip(*states[:2], strict=True)]
    close(model.plant().kinematics(*states[:2]), rates, 1e-10, "the plant's dq/dt against the symbols'")


def check_manifold(model: Model) -> None:
    """normalised() is a projection, and dq/dt stays on what it projects to."""
    of, (q, v, _) = symbols(model), random_states(model, 20, seed=5)
    for place, speed in zip(q, v, strict=True):
        close(
            np.asarray(of.normalised(place)).ravel(), place, 1e-12, "a normalised configuration, normalised"
        )
        tangent = 1e-6 * np.asarray(of.rate(place, speed)).ravel()
        moved = np.asarray(of.normalised(place + tangent) - of.normalised(place - tangent)).ravel()
        scale = 1e-6 * (1 + np.linalg.norm(tangent) * 1e6)
        close(
            moved / scale, 2 * tangent / scale, 1e-6, "dq/dt against its part along normalised configurations"
        )


def check_difference(model: Model) -> None:
    """difference(q0, q1) is odd, and (q0, q1) a time s of constant v apart give s v up to third order; constraint()."""
    n, k = len(model.configuration.names), len(model.velocity.names)
    q0, q1 = ca.SX.sym("q0", n), ca.SX.sym("q1", n)
    between = ca.Function("difference", [q0, q1], [space(model).difference(q0, q1)])
    place = ca.Function("constraint", [q0], [space(model).constraint(q0)])
    of, (q, v, _) = symbols(model), random_states(model, 10, seed=6)
    for start, speed in zip(q, v / np.maximum(np.abs(v).max(), 1.0), strict=True):
        ends = [_straight(of.rate, start, speed, s) for s in (0.02, 0.01)]
        gaps = [np.asarray(between(start, end)).ravel() for end in ends]
        require(gaps[0].shape == (k,), f"difference() has shape {gaps[0].shape}, not {(k,)}")
        errors = [np.max(np.abs(gap - s * speed)) for gap, s in zip(gaps, (0.02, 0.01), strict=True)]
        require(errors[0] < 1e-4, f"difference() after 0.02 s is off by {errors[0]:.1e}")
        require(errors[1] < errors[0] / 7 + 1e-12, f"difference() errs by {errors} at 0.02 and 0.01 s")
        close(-gaps[0], np.asarray(between(ends[0], start)).ravel(), 1e-12, "difference(q1, q0)")
        close(np.asarray(place(start)).ravel(), 0 * np.asarray(place(start)).ravel(), 1e-12, "constraint()")


def _straight(rate: ca.Function, q: Array, v: Array, seconds: float) -> Array:
    """Where constant v leads."""
    flown = solve_ivp(
        lambda t, y: np.asarray(rate(y, v)).ravel(), (0, seconds), q, method="DOP853", rtol=1e-13, atol=1e-14
    )
    return np.asarray(flown.y[:, -1])


def check_outputs(model: Model) -> None:
    """Names and limits fit, and the symbols' y(q, v) equal the plant's."""
    n, k = len(model.configuration.names), len(model.velocity.names)
    q, v = ca.SX.sym("q", n), ca.SX.sym("v", k)
    symbols_of = ca.Function("output", [q, v], [output(model, q, v)])
    count = len(output_box(model).names)
    require(symbols_of.size1_out(0) == count, f"{count} names, but {symbols_of.size1_out(0)} outputs")
    states = random_states(model, 20, seed=7)[:2]
    ours = np.array([np.asarray(symbols_of(*state)).ravel() for state in zip(*states, strict=True)])
    close(model.plant().output(*states), ours.reshape(20, count), 1e-9, "the plant's outputs")
    for low, high in (output_bounds(model, np.zeros(3)), output_bounds(model, np.full(3, 1e3))):
        require(low.shape == high.shape == (3, count) and np.all(low <= high), "output_limits() do not fit")


def check_virtual_work(model: Model) -> None:
    """Q . v equals dE/dt along the plant's motion, by central differences of E; random v span all directions."""
    if not isinstance(model, LagrangianModel):
        return
    of, plant = energies(model), model.plant()
    for q, v, u in zip(*random_states(model, 20, seed=1), strict=True):
        around = [float(of.energy(*_flown(plant, q, v, u, s))) for s in (-2e-4, -1e-4, 1e-4, 2e-4)]
        power = (around[0] - 8 * around[1] + 8 * around[2] - around[3]) / 12e-4
        given = float(v @ np.asarray(of.force(q, v, u)).ravel())
        scale = 1 + abs(float(of.energy(q, v)))
        close(power / scale, given / scale, 1e-7, "power gained by the plant against Q . v")


def _flown(plant: Plant, q: Array, v: Array, u: Array, step: float) -> tuple[Array, Array]:
    """One Runge-Kutta step of the plant, exact to fourth order."""
    n = len(q)

    def slope(y: Array) -> Array:
        return np.concatenate([plant.kinematics(y[:n], y[n:]), plant.acceleration(y[:n], y[n:], u)])

    y = np.concatenate([q, v])
    a = slope(y)
    b = slope(y + step / 2 * a)
    c = slope(y + step / 2 * b)
    d = slope(y + step * c)
    y = y + step / 6 * (a + 2 * b + 2 * c + d)
    return y[:n], y[n:]


def check_energy(model: Model) -> None:
    """The symbols' motion under random held inputs gains exactly the work of Q."""
    if not isinstance(model, LagrangianModel):
        return
    of, accelerate, q0 = energies(model), symbols(model).acceleration, at_rest(model)
    n, k, rate = len(q0), len(model.velocity.names), symbols(model).rate
    draw = np.random.default_rng(2)
    share = draw.uniform(0, 0.2, len(model.inputs.names))
    u = (1 - share) * model.hover() + share * limited(model.inputs)[1]
    start = np.concatenate([q0, draw.uniform(-0.3, 0.3, k), [0.0]])

    def flow(t: float, y: Array) -> Array:
        q, v = y[:n], y[n : n + k]
        a, force = (np.asarray(f(q, v, u)).ravel() for f in (accelerate, of.force))
        return np.concatenate([np.asarray(rate(q, v)).ravel(), a, [v @ force]])

    end = solve_ivp(flow, (0, 0.3), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    gained = float(of.energy(end[:n], end[n : n + k]) - of.energy(q0, start[n : n + k]))
    close(gained, end[-1], 1e-8, "energy gained in 0.3 s against the work of Q")


def check_rest(model: Model) -> None:
    """hover() holds a configuration within the limits, by plant and by symbols."""
    q = at_rest(model)
    still = np.zeros(len(model.velocity.names))
    a = np.asarray(symbols(model).acceleration(q, still, model.hover())).ravel()
    close(a, still, 1e-8, "the symbols' acceleration at rest under hover()")


def check_geometry(model: Model) -> None:
    """tool() and nose() against the plant's."""
    of, plant = symbols(model), model.plant()
    q, v, _ = random_states(model, 20, seed=3)
    position, velocity = plant.tool(q, v)
    ours = [[np.asarray(x).ravel() for x in of.tool(*state)] for state in zip(q, v, strict=True)]
    close(position, [p for p, _ in ours], 1e-10, "the plant's tool position against the symbols'")
    close(velocity, [w for _, w in ours], 1e-10, "the plant's tool velocity against d tool / dt")
    nose = plant.nose(q)
    close(
        nose, [np.asarray(of.nose(row)).ravel() for row in q], 1e-10, "the plant's nose against the symbols'"
    )
    close(np.linalg.norm(nose, axis=-1), np.ones(len(q)), 1e-10, "length of nose")
    for name, line in plant.skeleton(q[0]).items():
        require(line.ndim == 2 and line.shape[1] == 3, f"skeleton line {name} has shape {line.shape}")


def check_batch(model: Model) -> None:
    """The plant treats leading axes as a batch."""
    plant, (q, v, u) = model.plant(), random_states(model, 6, seed=4)
    single = [plant.acceleration(*state) for state in zip(q, v, u, strict=True)]
    folded = plant.acceleration(*(x.reshape(2, 3, -1) for x in (q, v, u)))
    close(folded.reshape(6, -1), single, 1e-12, "accelerations of a batch against one by one")
    tips = [plant.tool(*state)[0] for state in zip(q, v, strict=True)]
    close(
        plant.tool(q.reshape(2, 3, -1), v.reshape(2, 3, -1))[0].reshape(6, 3), tips, 1e-12, "tool of a batch"
    )
    noses = plant.nose(q.reshape(2, 3, -1)).reshape(6, 3)
    close(noses, [plant.nose(row) for row in q], 1e-12, "nose of a batch")


CHECKS = (
    check_limits, check_mass_matrix, check_acceleration, check_manifold, check_difference, check_outputs,
    check_virtual_work, check_energy, check_rest, check_geometry, check_batch,
    check_way_from_rest,
)  # fmt: skip
