"""A transcription as an integrator: fix where a flight starts and what it is told, solve for the rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse.linalg import splu

from benchbench.conformance.checks.require import require
from benchbench.conformance.checks.rows import Equations, Limits
from benchbench.conformance.checks.states import at_rest
from benchbench.ground.arrays import Array, Flags, Index
from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.handover import Handover
from benchbench.ocp.model import Model
from benchbench.ocp.motion import Motion
from benchbench.ocp.plan import Plan, bezier
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Phase, Trajectory

Signal = Callable[[Array], Array]
"""Times (n,) s to inputs (n, n_u)."""


class Nowhere(Motion):
    """A target at the origin, for scenarios without any contact."""

    @property
    def parameters(self) -> Array:
        """None."""
        return np.zeros(0)

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Origin."""
        return ca.SX.zeros(3)


def scenario_of(model: Model, **changes: object) -> Handover:
    """Start and end at rest in one configuration, nothing to touch."""
    pose = dict(zip(model.configuration.names, at_rest(model).tolist(), strict=True))
    fields: dict[str, object] = {
        "name": "conformance",
        "start": pose,
        "end": pose,
        "target": Nowhere(),
        "contacts": {},
    }
    return Handover(**(fields | changes))  # type: ignore[arg-type]


def one_phase(intervals: int, seconds: float) -> Grid:
    """Time axis of fixed length."""
    return Grid((Phase("flight", intervals, seconds, seconds, seconds),))


@dataclass(frozen=True)
class Transcribed:
    """A dynamics plugin's answer for a model on a grid."""

    mpcc: Mpcc
    trajectory: Trajectory

    @property
    def interpolation(self) -> str:
        """How its plans say inputs act between nodes."""
        return self.decode(self.mpcc.guess).interpolation

    def decode(self, x: Array) -> Plan:
        """Plan of stacked unknowns (n,)."""
        return self.trajectory.decode(self.mpcc.split(x), np.zeros(self.trajectory.grid.intervals + 1))

    def encode(self, plan: Plan) -> Array:
        """Stacked unknowns (n,), guessed from a plan; what `encode` does not give keeps its guess."""
        values = self._guessed | self.trajectory.encode(plan)
        return np.concatenate([np.ravel(values[v.name]) for v in self.mpcc.variables])

    @cached_property
    def limits(self) -> Limits:
        """Bounds, and rows that are no equations."""
        return Limits(self.mpcc)

    @cached_property
    def _guessed(self) -> dict[str, Array]:
        return self.mpcc.split(self.mpcc.guess)


def transcribe(dynamics: Dynamics, model: Model, grid: Grid, scenario: Scenario | None = None) -> Transcribed:
    """Ask the plugin."""
    return Transcribed(*dynamics.transcribe(scenario or scenario_of(model), model, grid))


def fly(model: Model, plan: Plan) -> Plan:
    """Replace the states of a plan by those its inputs lead to from its start: DOP853 on the plant, 1e-13.

    Several transcriptions are held against one flight: it is made once.
    """
    told = (plan.configuration[0], plan.velocity[0], plan.time, plan.input_pieces)
    key = id(model), tuple(part.tobytes() for part in told)
    if key not in _FLOWN:
        _FLOWN[key] = model, _flown(model, plan)
    y, n = _FLOWN[key][1], plan.configuration.shape[1]
    return replace(plan, configuration=y[:, :n], velocity=y[:, n:])


_FLOWN: dict[tuple[int, tuple[bytes, ...]], tuple[Model, Array]] = {}
"""Models, which keep their identity so, and states (N + 1, n) at the nodes."""


def _flown(model: Model, plan: Plan) -> Array:
    plant, n = model.plant(), plan.configuration.shape[1]
    states, last = [np.concatenate([plan.configuration[0], plan.velocity[0]])], np.inf
    for t0, t1, points in zip(plan.time[:-1], plan.time[1:], plan.input_pieces, strict=True):

        def flow(t: float, y: Array, t0: float = t0, t1: float = t1, points: Array = points) -> Array:
            u = points[0] if len(points) == 1 else bezier(points, (t - t0) / (t1 - t0))
            return np.concatenate([plant.kinematics(y[:n], y[n:]), plant.acceleration(y[:n], y[n:], u)])

        first = min(t1 - t0, last)  # shortened if it is too long
        found = solve_ivp(
            flow, (t0, t1), states[-1], method="DOP853", rtol=1e-13, atol=1e-14, first_step=first
        )
        last = float(np.max(np.diff(found.t)))
        states.append(found.y[:, -1])
    return np.array(states)


def told(transcribed: Transcribed, q0: Array, v0: Array, signal: Signal) -> Plan:
    """A plan that stays at q0, v0, with a signal sampled as the dynamics declares its inputs."""
    plan = transcribed.decode(transcribed.mpcc.guess)
    time = plan.time
    at = (time[:-1] + time[1:]) / 2 if plan.interpolation == "hold" else plan.input_times
    tile = (len(time), 1)
    return replace(plan, configuration=np.tile(q0, tile), velocity=np.tile(v0, tile), inputs=signal(at))


def integrate(transcribed: Transcribed, order: Plan, guess: Plan | None = None) -> Plan:
    """Solve the transcription's equations by Newton's method, with start, times and inputs of `order` held.

    The inputs are those that `order` becomes when it is encoded; the other unknowns start from `guess`.
    Fails when the equations do not determine the rest, or Newton does not end.
    """
    equations = Equations(transcribed.mpcc)
    x = transcribed.encode(order)
    free = np.flatnonzero(~_given(transcribed, x))
    x[free] = transcribed.encode(guess or order)[free]
    require(
        len(free) == len(equations),
        f"{len(free)} unknowns are left when start, times and inputs are fixed, but there are {len(equations)} equations",
    )
    for _ in range(30):
        residual, jacobian = equations.at(x)
        step = splu(jacobian[:, free].tocsc()).solve(-residual)
        x[free] += step
        if np.max(np.abs(step)) < 1e-12 * (1 + np.max(np.abs(x))):
            return transcribed.decode(x)
    raise AssertionError(
        f"the equations cannot be solved near the guess; last Newton step {np.max(np.abs(step)):.1e}"
    )


def _given(transcribed: Transcribed, x: Array) -> Flags:
    """Which unknowns decide times, inputs and the first state of the decoded plan; found by moving each.

    Of a column whose later rows change nothing together, they are not moved one by one.
    """

    def said(at: Array) -> Array:
        plan = transcribed.decode(at)
        return np.concatenate([plan.time, plan.inputs.ravel(), plan.configuration[0], plan.velocity[0]])

    def decide(these: Index) -> bool:
        moved = x.copy()
        moved[these] += 1e-3 * np.linspace(
            1.0, 2.0, len(these)
        )  # by unequal steps, which no difference hides
        return not np.array_equal(said(moved), before)

    before, given = said(x), np.zeros(len(x), bool)
    for column in _columns(transcribed.mpcc):
        one_by_one = column if decide(column[1:]) else column[:1]
        for i in one_by_one:
            given[i] = decide(np.array([i]))
    return given


def _columns(mpcc: Mpcc) -> Iterator[Index]:
    """Places of each variable's columns, one row per node or interval, among the stacked unknowns."""
    for variable in mpcc.variables:
        places = np.arange(variable.size) + mpcc.offsets[variable.name]
        yield from places.reshape(variable.guess.shape).T
