"""How a dynamics plugin converges to the motion of the plant, and what it does to energy.

order         nodal values converge with `order` to the motion of the plant under the same inputs, for any
              model: forced, damped, with a mass matrix that depends on q; also over phases of unequal steps
consistency   one step from an exact state errs with `order` + 1
"""

from __future__ import annotations

from itertools import pairwise

import casadi as ca
import numpy as np

from benchbench.conformance.checks.initial_value import Signal, fly, integrate, one_phase, told, transcribe
from benchbench.conformance.checks.require import require
from benchbench.conformance.checks.states import at_rest, limited, normalised
from benchbench.ocp.mechanics import lagrangian_model
from benchbench.ocp.model import Model
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Phase

FLOOR = 1e-12
"""Errors below this are rounding and say nothing about an order."""
SHORT = 0.2
"""By how much a measured order may fall short of the declared one."""
AGILE = 5.0
"""Acceleration in m/s^2 or rad/s^2 above which coarse grids are too coarse to show an order."""


def check_order(dynamics: Dynamics, model: Model, seconds: float = 0.4) -> str:
    """Whole flights on 8 and 16 intervals; returns what was measured.

    On fewer as well where those err by rounding only, on 32 and 64 where an order only shows there.

    A coarse grid may hide an order, where an error changes its sign, but no refinement shows one that is not there.
    """
    signal = wave(model)

    def on(*counts: int) -> list[float]:
        return [flight_error(dynamics, model, one_phase(count, seconds), signal) for count in counts]

    errors = on(8, 16)
    if errors[0] <= FLOOR or errors[1] <= FLOOR:
        errors = [*on(2, 4), *errors]
    if _order(errors) < dynamics.order - SHORT:
        errors += on(32, 64)
    return _judge(errors, dynamics.order, "order")


def check_consistency(dynamics: Dynamics, model: Model) -> str:
    """Single steps of 0.2 to 0.0125 s from an exact state under one constant input; returns what was measured."""
    at_once = wave(model)(np.zeros(1))
    errors = [
        flight_error(dynamics, model, one_phase(1, step), lambda time: np.repeat(at_once, len(time), axis=0))
        for step in (0.2, 0.1, 0.05, 0.025, 0.0125)
    ]
    return _judge(errors, dynamics.order + 1, "local order")


def check_phases(dynamics: Dynamics, model: Model) -> str:
    """Flights of 0.4 s over three phases of different steps, each refined twice; returns what was measured."""
    signal = wave(model)
    errors = [flight_error(dynamics, model, _three(m), signal) for m in (1, 2, 4)]
    return _judge(errors, dynamics.order, "order on three phases")


def _three(refined: int) -> Grid:
    spans = {"approach": (2, 0.2), "contact": (1, 0.05), "leave": (1, 0.15)}
    return Grid(tuple(Phase(name, count * refined, s, s, s) for name, (count, s) in spans.items()))


def flight_error(dynamics: Dynamics, model: Model, grid: Grid, signal: Signal) -> float:
    """Largest error of nodal q and v against the plant, from a moving start under the same sampled inputs."""
    transcribed = transcribe(dynamics, model, grid)
    start = normalised(model, at_rest(model)[None] + 0.1)[0]
    order = told(transcribed, start, 0.2 * np.cos(np.arange(len(model.velocity.names))), signal)
    exact = fly(model, transcribed.decode(transcribed.encode(order)))
    got = integrate(transcribed, order, exact)
    error_q, error_v = got.configuration - exact.configuration, got.velocity - exact.velocity
    return float(max(np.max(np.abs(error_q)), np.max(np.abs(error_v))))


def wave(model: Model) -> Signal:
    """Hover and a slow wave on each input, five percent of its range, less for an agile vehicle."""
    low, high = limited(model.inputs)
    rest, phase = at_rest(model), np.arange(len(low))
    still = np.zeros(len(model.velocity.names))
    pushed = model.hover() + 0.05 * np.diag(high - low)
    strongest = max(float(np.max(np.abs(model.plant().acceleration(rest, still, u)))) for u in pushed)
    size = 0.05 * min(1.0, AGILE / strongest) * (high - low)
    return lambda time: model.hover() + size * np.sin(5 * time[:, None] + 1 + phase)


def _order(errors: list[float]) -> float:
    """Of the last halving whose error is no rounding."""
    pairs = [(a, b) for a, b in pairwise(errors) if b > FLOOR]
    return float(np.log2(pairs[-1][0] / pairs[-1][1])) if pairs else np.inf


def _judge(errors: list[float], wanted: float, what: str) -> str:
    measured = _order(errors)
    text = f"{what} {measured:.2f}, declared {wanted:g}; errors {', '.join(f'{e:.1e}' for e in errors)}"
    require(measured >= wanted - SHORT, text)
    return text


def energy_errors(
    dynamics: Dynamics, model: Model, seconds: float = 5.0, step: float = 0.05
) -> tuple[float, float]:
    """Largest energy error of a swing without work, relative to the energy range of the exact flight's parts.

    Returns the first and the second half's maximum: equal for a symplectic method, growing for others.
    The model must be conservative under hover().
    """
    transcribed = transcribe(dynamics, model, one_phase(round(seconds / step), seconds))
    plan = told(
        transcribed, at_rest(model) + 1.0, 0 * at_rest(model), lambda t: np.tile(model.hover(), (len(t), 1))
    )
    got = integrate(transcribed, plan, fly(model, plan))
    n = len(model.configuration.names)
    q, v = ca.SX.sym("q", n), ca.SX.sym("v", n)
    of = lagrangian_model(model)
    lagrangian, kinetic = of.lagrangian(q, v), of.lagrangian(q, v) - of.lagrangian(q, ca.SX.zeros(n))
    energy = ca.Function("energy", [q, v], [2 * kinetic - lagrangian, kinetic])
    total, moving = (np.asarray(x).ravel() for x in energy(got.configuration.T, got.velocity.T))
    error = np.abs(total - total[0]) / np.max(moving)
    half = len(error) // 2
    return float(np.max(error[:half])), float(np.max(error[half:]))
