"""Refuses a case that cannot work before anything is built, naming the field and what is allowed."""

from __future__ import annotations

import contextlib
import io
import re
from functools import singledispatch

import numpy as np

from benchbench.certificate.bound import lower_bound
from benchbench.certificate.conflict import conflicts
from benchbench.certificate.speed_bound import arm_reach
from benchbench.ground import registry
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.mpcc.problem import Mpcc, Variable, block, rows
from benchbench.nlp.solver import Setup
from benchbench.ocp.contact import in_words
from benchbench.ocp.handover import Handover
from benchbench.ocp.model import AXES, LagrangianModel, RacingModel, travels
from benchbench.ocp.motion import sample
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.sizes import INTERVALS
from benchbench.ocp.stop import Stop
from benchbench.ocp.transfer import Transfer
from benchbench.planning.case import AnyCase, Case
from benchbench.planning.posture import nearest_touch


def validate(case: AnyCase) -> None:
    """Raise BadInput for the first thing that cannot be."""
    if isinstance(case, Case):
        _flight(case)
    _schedule(case)
    _solver(case)


def _flight(case: Case) -> None:
    numbers(case)
    suits(case.scenario, case)
    _vehicle(case)
    _pose("start", case.scenario.start_point(case.model), case)
    _pose("end", case.scenario.end_point(case.model), case)
    _clear(case)
    possible(case.scenario, case)


@singledispatch
def suits(scenario: Scenario, case: Case) -> None:
    """Raise IncompatibleCase for a vehicle that lacks what this kind of scenario needs; unless it says otherwise, a place of its own."""
    if not travels(case.model):
        problem = f"'{case.names['vehicle']}' has no coordinates x, y, z and cannot fly this scenario"
        raise IncompatibleCase("vehicle", problem, "a vehicle with them")


@suits.register(Handover)
@suits.register(Transfer)
def _(scenario: Scenario, case: Case) -> None:
    """Whatever has an end effector."""


@singledispatch
def possible(scenario: Scenario, case: Case) -> None:
    """Raise BadInput where stops are out of reach, or the time is too short."""
    for stop in scenario.itinerary.stops:
        _near(stop, case)
    latest = scenario.travel_time[1]
    bound = lower_bound(scenario, case.model, case.model.plant())
    if bound == np.inf:
        contradiction(scenario, case)
        problem = f"is out of reach: at full speed the vehicle does not meet it within {latest:g} s"
        raise BadInput(_field(scenario), problem, "a nearer target, or a longer scenario.travel_time")
    if bound > latest:
        problem = f"{latest:g} s are too short, at full speed the flight takes {bound:.3f} s"
        raise BadInput("scenario.travel_time", problem, f"an upper limit of at least {bound:.3f} s")


@singledispatch
def contradiction(scenario: Scenario, case: Case) -> None:
    """Raise BadInput that names two demands that no flight keeps both, where this kind of scenario has such."""


@contradiction.register
def _(scenario: Handover, case: Case) -> None:
    for stop, found in conflicts(scenario, case.model, case.model.plant()):
        problem = f"is out of reach, by proof: {found.asked}, and {found.able}"
        raise BadInput(_field(scenario, stop), problem, "a task in which one of the two is eased")


def numbers(case: Case) -> None:
    """Raise BadInput for counts and durations that do not fit into each other."""
    scenario = case.scenario
    stops = scenario.itinerary.listed
    if scenario.grid_intervals > INTERVALS:
        problem = f"the grid has {scenario.grid_intervals} intervals"
        field = "nodes_per_gate" if "nodes_per_gate" in type(scenario).model_fields else "intervals"
        raise BadInput(f"scenario.{field}", problem, f"at most {INTERVALS} in all")
    most = (
        scenario.grid_intervals - len(stops) - 1
    )  # one interval to come, one from stop to stop, one to leave
    asked = sum(stop.kappa_init for stop in stops)
    if asked > most:
        problem = f"{asked} nodes in contact do not fit into {scenario.grid_intervals} intervals"
        raise BadInput("scenario.kappa_init", problem, f"1 to {most}" + (" in all" if len(stops) > 1 else ""))
    first, last = scenario.travel_time
    if not 0 <= first <= last < np.inf or last == 0:
        raise BadInput(
            "scenario.travel_time", f"[{first}, {last}] was given", "two finite numbers of seconds from 0 on"
        )
    for stop in scenario.itinerary.stops:
        seconds = stop.contact_seconds
        if seconds is not None and not 0 < seconds < last:
            problem, allowed = f"{seconds} s is no part of the flight", f"null, or above 0 and below {last} s"
            raise BadInput("scenario.contact_seconds", problem, allowed)


def _schedule(case: AnyCase) -> None:
    schedule = np.asarray(case.relaxation.schedule)
    if not schedule.size or not np.all(np.isfinite(schedule)) or np.any(schedule < 0):
        problem = f"{list(case.relaxation.schedule)} was given"
        raise BadInput("relaxation.schedule", problem, "one or more finite numbers, none below 0")


def _vehicle(case: Case) -> None:
    """It can rest, and has the coordinates that the scenario speaks of."""
    model, scenario = case.model, case.scenario
    if not case.dynamics.accepts(model):
        _unsuitable_dynamics(case)
    scenario.limits(model)
    scenario.planned_rates(model)
    limits = model.inputs
    for name, unit, u, low, high in zip(
        limits.names, limits.units, model.hover(), limits.lower, limits.upper, strict=True
    ):
        if not low <= u <= high:
            problem = f"cannot hover: {name} would have to be {u:.4g} {unit}"
            raise BadInput(
                "vehicle", problem, f"its limits, {low:g} to {high:g} {unit}, wide enough for that"
            )


def _unsuitable_dynamics(case: Case) -> None:
    dynamics, vehicle = case.names["dynamics"], case.names["vehicle"]
    lacks = not isinstance(case.model, LagrangianModel)
    flag = "needs_lagrangian" if lacks else "needs_vector_space"
    able = [p.name for p in registry.installed("dynamics") if p.kind and not getattr(p.kind, flag, False)]
    problem = (
        f"'{dynamics}' needs a Lagrangian, which the vehicle '{vehicle}' lacks"
        if lacks
        else f"'{dynamics}' adds coordinates, which the quaternions of the vehicle '{vehicle}' do not allow"
    )
    raise IncompatibleCase("dynamics", problem, ", ".join(able))


def _pose(which: str, q: Array, case: Case) -> None:
    limits = case.scenario.limits(case.model)
    for name, unit, value, low, high in zip(
        limits.names, limits.units, q, limits.lower, limits.upper, strict=True
    ):
        if not low <= value <= high:
            problem, allowed = f"{value:g} {unit} is outside its limits", f"{low:g} to {high:g} {unit}"
            raise BadInput(f"scenario.{which}.{name}", problem, allowed)


def _clear(case: Case) -> None:
    """Start and end, where the end is one place, are clear of obstacles."""
    scenario, model, plant = case.scenario, case.model, case.model.plant()
    last = scenario.ends(model)
    places = {"start": (scenario.start_point(model), scenario.start_rates(model))}
    if np.array_equal(last.lower_q, last.upper_q) and np.array_equal(last.lower_v, last.upper_v):
        places["end"] = (last.lower_q, last.lower_v)
    for name, one in scenario.obstacles.items():
        for which, (q, v) in places.items():
            nowhere = np.zeros((1, 3))
            (gap,) = one.gap(plant, q[None], v[None], nowhere, nowhere)
            if not gap <= one.limit:
                problem = f"the {which} is {in_words(one, float(gap))}"
                raise BadInput(
                    f"scenario.obstacles.{name}",
                    problem,
                    f"another place for it, or another scenario.{which}",
                )


def _near(stop: Stop, case: Case) -> None:
    """Some time the target is near where the vehicle may be."""
    scenario, model = case.scenario, case.model
    target, _ = sample(stop.target, np.linspace(0.0, scenario.travel_time[1], 301))
    field = _field(scenario, stop)
    if not np.all(np.isfinite(target)):
        raise BadInput(field, "gives positions that are not finite", "finite positions in m")
    if not travels(model):
        _within_reach(field, stop, case, target)
        return
    limits = scenario.limits(model)
    reach = arm_reach(model, model.plant()) + (stop.reach or 0.0)
    for axis, column in zip(AXES, target.T, strict=True):
        i = limits.index(axis)
        low, high = limits.lower[i] - reach, limits.upper[i] + reach
        if not np.any((column >= low) & (column <= high)):
            problem = f"is out of reach: its {axis} goes from {column.min():g} to {column.max():g} m"
            raise BadInput(field, problem, f"{axis} between {low:g} and {high:g} m at some time")


def _within_reach(field: str, stop: Stop, case: Case, target: Array) -> None:
    """A robot that stands somewhere comes near the target with its end effector at some time."""
    nearest, _ = nearest_touch(case, target)
    if stop.reach is not None and nearest > stop.reach:
        problem = f"is out of reach: the end effector comes no nearer to it than {nearest:.3g} m"
        raise BadInput(field, problem, f"a target that comes within {stop.reach:g} m of where it can be")


def _field(scenario: Scenario, stop: Stop | None = None) -> str:
    """Name of the field that gives the target of a stop, or of all of them."""
    if not any(one.prefix for one in scenario.itinerary.stops):
        return "scenario.target"
    return "scenario.stops" if stop is None else f"scenario.stops.{stop.name}.target"


@suits.register
def _(scenario: Race, case: Case) -> None:
    """The vehicle says what a race is guessed from."""
    if not isinstance(case.model, RacingModel):
        able = "race_quadrotor, race_ramp, or a model that gives specific_thrust and follow"
        raise IncompatibleCase("vehicle", f"'{case.names['vehicle']}' cannot race", able)


@possible.register
def _(race: Race, case: Case) -> None:
    """Every gate can be reached at least in part, and there is time for the race."""
    limits = race.limits(case.model)
    for number, goal in enumerate(race.goals, 1):
        for axis, value in zip(AXES, goal.position, strict=True):
            i = limits.index(axis)
            low, high = limits.lower[i] - goal.radius, limits.upper[i] + goal.radius
            if not low <= value <= high:
                name = "end" if number == len(race.goals) else f"gate {number}"
                problem = f"{axis} = {value:g} m of the {name} is outside the workspace"
                raise BadInput("scenario.track", problem, f"{low:g} to {high:g} m")
    bound = lower_bound(race, case.model, case.model.plant())
    if bound > race.travel_time[1]:
        problem = f"{race.travel_time[1]:g} s are too short for this race"
        raise BadInput("scenario.travel_time", problem, f"an upper limit of at least {bound:.3f} s")


def _solver(case: AnyCase) -> None:
    """Let the solver prepare a problem with one unknown: settings that it refuses show here."""
    said = io.StringIO()
    setup = Setup(case.time_limit, case.iteration_limit, case.accuracy, "never")
    try:
        with contextlib.redirect_stdout(said):
            case.solver.prepare(_smallest(), setup)
    except IncompatibleCase:
        return  # it needs a problem with a certain structure; this one has none
    except RuntimeError as error:
        reason = re.sub(r"^\S+\.[ch]pp:\d+: ", "", str(error).strip().splitlines()[-1])
        reason += f" ({said.getvalue().strip().splitlines()[0]})" if said.getvalue().strip() else ""
        options = getattr(case.solver, "options", None)
        problem = f"'{case.names['solver']}' refuses its settings{f' {options}' if options else ''}: {reason}"
        raise BadInput("solver", problem, "what the solver's own manual names") from None


def _smallest() -> Mpcc:
    """Minimise (x - 1)^2 for -2 <= x <= 2."""
    two, x = np.full((1, 1), 2.0), [rows("x", 1, [0])]
    cost = block("probe_cost", x, lambda x: (x - 1) ** 2)
    row = block("probe_row", x, lambda x: x, -2.0, 2.0)
    return Mpcc((Variable("x", -two, two, 0 * two),), (row,), (cost,))
