"""From a case with stops on the way to the problems it can be posed as: free contact, fixed windows, phases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from benchbench.formulation import open_order
from benchbench.formulation.coupling import Coupling
from benchbench.formulation.formulation import Formulation
from benchbench.formulation.problem import NodesByStop, Problem
from benchbench.formulation.transcribed import transcribed
from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Mpcc, block
from benchbench.ocp.contact import still
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Itinerary, Stop, spread
from benchbench.transcription.grid import Grid, Phase, Trajectory
from benchbench.transcription.nodal import durations

SHORTEST = 1e-4
"""Shortest duration of a phase in s."""
WHOLE = 0.5
"""A guess whose progress index is nowhere above this share of a step says that, but not when, there is contact."""

TO_CONTACT = 13 / 12
"""Intervals of a leg that ends in a contact over those of the last leg: 52 to 48 for one contact. What is flown before a
contact must be flown more accurately than what comes after it."""

CONTACT_STEP = 0.06
"""Longest interval of a contact in s. Its conditions are kept at nodes: over 0.11 s (N = 25) the relative speed in between
reaches 0.05 m/s where 0.015 are allowed, over 0.055 s (N = 50) it stays below."""


def free_contact(case: Formulation, start: Plan) -> Problem:
    """The paper's DMCC: one step size, progress variables, complementarity; guessed from a plan."""
    base, trajectory = _flight(case, start)
    itinerary = case.scenario.itinerary
    if not itinerary.stops:
        return Problem(base, trajectory, {})
    mpcc = base + open_order.by_progress(
        itinerary, [_coupling(case, trajectory, stop) for stop in itinerary.stops]
    )
    guess = {f"{stop.prefix}kappa": _kappa(start, trajectory, stop) for stop in itinerary.stops}
    if itinerary.visit != "all":
        guess[open_order.MADE] = np.array(
            [guess[f"{s.prefix}kappa"][:1] / s.kappa_init for s in itinerary.stops]
        )
    return Problem(mpcc.start_from(guess), trajectory, None, _kappas(itinerary))


def fixed_window(case: Formulation, start: Plan, nodes: Sequence[int]) -> Problem:
    """One step size, contact with the only stop imposed at the given nodes: smooth."""
    return fixed_windows(case, start, {case.scenario.itinerary.stops[0].name: tuple(nodes)})


def fixed_windows(case: Formulation, start: Plan, contact: NodesByStop) -> Problem:
    """One step size, contact with each stop that is named imposed at its nodes: smooth."""
    base, trajectory = _flight(case, start)
    return _at_windows(case, base, trajectory, contact)


def nearest_held(case: Formulation, start: Plan) -> Problem:
    """The same at the nodes nearest to a plan's contacts."""
    return fixed_windows(case, start, nearest_windows(case, start))


def phases(case: Formulation, start: Plan) -> Problem:
    """Approach, contact, transfer to the next contact, ..., leave with own step sizes: smooth.

    The stops are those that `start` claims, in its order. Each contact lasts its `contact_seconds`, or
    kappa_init - 1 average steps, so that it means the same as in the paper's form; for kappa_init = 1 it is one
    node between the phases. Raises IncompatibleCase for a start that claims no stop where one has to be made.
    """
    itinerary = case.scenario.itinerary
    made = claimed_stops(itinerary, start)
    if not made and not itinerary.may_skip_all:
        fault = f"the start that it gives touches none of {', '.join(itinerary.names)}"
        raise IncompatibleCase("guess", fault, "one with a contact, such as simple; or strategy=relax")
    grid, contact, averaged = phase_grid(case, start, made)
    base, trajectory = transcribed(case, grid)
    problem = _at_windows(case, base.start_from(trajectory.encode(start)), trajectory, contact)
    steps = (_average_steps(grid, phase, stop) for phase, stop in averaged)
    return replace(problem, mpcc=sum(steps, problem.mpcc))


def phase_grid(
    case: Formulation, start: Plan, made: Sequence[Stop]
) -> tuple[Grid, NodesByStop, list[tuple[int, Stop]]]:
    """Time axis of the phases, as long as in a plan that makes these stops, else spread over its travel time.

    Also returns the nodes of each contact, and which phases are contacts whose duration is a number of steps.
    """
    scenario, found, travel_time = case.scenario, list[Phase](), start.travel_time
    total = scenario.grid_intervals
    contact: dict[str, tuple[int, ...]] = {}
    averaged: list[tuple[int, Stop]] = []
    longest = scenario.travel_time[1]
    inside = [_contact_intervals(stop, travel_time, total) for stop in made]
    flown = total - sum(inside)
    legs = np.diff(np.rint(flown * np.cumsum([0.0, *_leg_shares(len(made))])).astype(int))
    marks = np.array([0.0, *_contact_times(case, start, made), travel_time])
    names = ["approach", *(f"transfer_to_{stop.name}" for stop in made[1:]), "leave"]
    for i, stop in enumerate(made):
        found.append(Phase(names[i], int(legs[i]), SHORTEST, longest, marks[i + 1] - marks[i]).on(case.mesh))
        first = sum(phase.intervals for phase in found)
        contact[stop.name] = (first,)
        if not inside[i]:
            continue
        seconds = stop.contact_seconds
        steps, counted = stop.steps(total)
        guess = steps * travel_time / counted if seconds is None else seconds
        low, high = (SHORTEST, longest) if seconds is None else (seconds, seconds)
        if seconds is None:
            averaged.append((len(found), stop))
        found.append(Phase(f"{stop.prefix}contact", inside[i], low, high, guess).on(case.mesh))
        contact[stop.name] = tuple(range(first, first + found[-1].intervals + 1))
    last = names[len(made)] if made else "flight"
    found.append(Phase(last, int(legs[-1]), SHORTEST, longest, marks[-1] - marks[-2]).on(case.mesh))
    return Grid(tuple(found)), contact, averaged


def _contact_intervals(stop: Stop, travel_time: float, total: int) -> int:
    """Intervals of a contact: between kappa_init nodes, and where it lasts for seconds, no longer than the average.

    On a coarse grid more, so that none is longer than `CONTACT_STEP`, up to a quarter of all.
    """
    if stop.contact_seconds is None:
        steps, grid = stop.steps(total)
        wanted = int(np.ceil(steps / (grid / travel_time) / CONTACT_STEP))
        return max(stop.kappa_init - 1, min(wanted, total // 4))
    wanted = min(int(np.ceil(stop.contact_seconds * (total / travel_time))), total // 4)
    return max(stop.kappa_init - 1, wanted, 1)


def _leg_shares(stops: int) -> Array:
    """Shares of the intervals for each leg, (stops + 1,): a leg that ends in a contact has more than the last one."""
    weights = np.array([TO_CONTACT] * stops + [1.0])
    return weights / weights.sum()


def _contact_times(case: Formulation, start: Plan, made: Sequence[Stop]) -> Array:
    """When a plan makes these stops, (stops,) s: the middle of each contact, where it claims them in this order."""
    names = [stop.name for stop in made]
    found = [start.contact(start.stop_names.index(name)) for name in names if name in start.stop_names]
    times = [float(start.time[list(nodes)].mean()) for nodes in found if nodes is not None]
    if len(times) == len(made) and np.all(np.diff([0.0, *times, start.travel_time]) > SHORTEST):
        return np.array(times)
    return start.travel_time * spread(len(made), case.scenario.itinerary.middle)


def nearest_window(plan: Plan, trajectory: Trajectory, count: int, stop: str = "") -> tuple[int, ...]:
    """The `count` consecutive nodes of a one-phase grid whose middle is nearest to the plan's contact.

    stop: whose contact, by name; the plan's first one if not given.
    """
    progress = plan.progress_by_stop[:, plan.stop_names.index(stop) if stop else 0]
    claimed = plan.time[progress > 0.5 * progress.max()]
    middle = (claimed[0] + claimed[-1]) / 2
    time = trajectory.grid.time_weights @ trajectory.encode(plan)["T"].ravel()
    last = trajectory.grid.intervals - count
    first = int(np.argmin(np.abs((time[: last + 1] + time[count - 1 : count + last]) / 2 - middle)))
    return tuple(range(first, first + count))


def nearest_windows(case: Formulation, plan: Plan) -> NodesByStop:
    """The nearest window of the one-phase grid for every stop that a plan makes."""
    _, trajectory = _flight(case, plan)
    return {
        stop.name: nearest_window(plan, trajectory, stop.kappa_init, stop.name)
        for stop in claimed_stops(case.scenario.itinerary, plan)
    }


def claimed_stops(itinerary: Itinerary, plan: Plan) -> tuple[Stop, ...]:
    """The stops that a plan makes, in its order."""
    first = {
        stop: int(np.argmax(_claims(plan, stop.name) > WHOLE))
        for stop in itinerary.stops
        if stop.name in plan.stop_names and _claims(plan, stop.name).max() > WHOLE
    }
    return tuple(sorted(first, key=lambda stop: first[stop]))


def _claims(plan: Plan, stop: str) -> Array:
    return plan.progress_by_stop[:, plan.stop_names.index(stop)]


def _kappa(start: Plan, trajectory: Trajectory, stop: Stop) -> Array:
    """Guess of kappa (N + 1,): the nearest window, or where a plan only spreads its progress, as it does."""
    nodes = trajectory.grid.intervals
    progress = _claims(start, stop.name)
    if progress.max() > WHOLE:
        window = nearest_window(start, trajectory, stop.kappa_init, stop.name)
        return stop.kappa_init - np.concatenate([[0.0], np.cumsum(np.isin(np.arange(nodes), window))])
    to_come = np.cumsum(progress[::-1])[::-1]
    share = np.linspace(0.0, start.travel_time, nodes + 1)
    return np.interp(share, start.time, to_come)


def _flight(case: Formulation, start: Plan) -> tuple[Mpcc, Trajectory]:
    scenario = case.scenario
    grid = Grid((Phase("flight", scenario.grid_intervals, *scenario.travel_time, start.travel_time),))
    base, trajectory = transcribed(case, grid)
    return base.start_from(trajectory.encode(start)), trajectory


def _at_windows(case: Formulation, base: Mpcc, trajectory: Trajectory, contact: NodesByStop) -> Problem:
    itinerary = case.scenario.itinerary
    made = [stop for stop in itinerary.stops if stop.name in contact]
    for stop in made:
        base += _coupling(case, trajectory, stop).at_nodes(contact[stop.name])
        if stop.name in case.resting:
            base += _not_before(trajectory.grid, contact[stop.name][0], stop, case.resting[stop.name])
    return Problem(base + open_order.choice(itinerary, made), trajectory, contact, _kappas(itinerary))


def _coupling(case: Formulation, trajectory: Trajectory, stop: Stop) -> Coupling:
    contacts = still(stop.contacts) if stop.name in case.resting else stop.contacts
    margins = case.scenario.itinerary.margins
    return Coupling(contacts, case.model, stop.target, trajectory, margins, stop.prefix)


def _kappas(itinerary: Itinerary) -> dict[str, str]:
    """Name of the progress variable of every stop, by the stop's name."""
    return {stop.name: f"{stop.prefix}kappa" for stop in itinerary.stops}


def _average_steps(grid: Grid, phase: int, stop: Stop) -> Mpcc:
    """T_contact = (kappa_init - 1) t_N / N, with N of the grid whose nodes are counted."""
    steps, counted = stop.steps(grid.intervals)
    rule = block(
        f"{stop.prefix}contact_duration", [durations(grid, 1)],
        lambda duration, p: duration[phase] - p * ca.sum1(duration),
        parameters=np.array([[steps / counted]]), unit="s", function="contact_duration",
        symbols="T",
    )  # fmt: skip
    return Mpcc((), (rule,))


def _not_before(grid: Grid, node: int, stop: Stop, seconds: float) -> Mpcc:
    """A node is reached after so many s at least."""
    rule = block(
        f"{stop.prefix}stands", [durations(grid, 1)], lambda duration, p: ca.dot(p, duration), seconds, np.inf,
        parameters=grid.time_weights[[node]], unit="s", function="stands", symbols="T",
    )  # fmt: skip
    return Mpcc((), (rule,))
