"""From a case to the three problems a handover can be posed as: free contact, fixed window, phases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.case import Case
from benchbench.contact import Coupling, progress_index
from benchbench.dynamics import Grid, Phase, Trajectory
from benchbench.mpcc import Block, Mpcc
from benchbench.plan import Array, Plan
from benchbench.transcription import durations

SHORTEST = 1e-4
"""Shortest duration of a phase in s."""


@dataclass(frozen=True)
class Problem:
    """An MPCC and how to read its unknowns; `contact` are the nodes in contact when they are fixed."""

    mpcc: Mpcc
    trajectory: Trajectory
    contact: tuple[int, ...] | None

    def decode(self, values: dict[str, Array]) -> Plan:
        """Turn named values into a plan with its progress index."""
        if self.contact is None:
            return self.trajectory.decode(values, progress_index(values["kappa"]))
        progress = np.zeros(self.trajectory.grid.intervals + 1)
        progress[list(self.contact)] = 1.0
        return self.trajectory.decode(values, progress)


def free_contact(case: Case, start: Plan) -> Problem:
    """The paper's DMCC: one step size, progress variables, complementarity; guessed from a plan."""
    base, trajectory, coupling = _flight(case, start)
    mpcc = base + coupling.by_progress(case.scenario.kappa_init)
    window = nearest_window(start, trajectory, case.scenario.kappa_init)
    in_contact = np.isin(np.arange(case.scenario.intervals), window)
    kappa = case.scenario.kappa_init - np.concatenate([[0.0], np.cumsum(in_contact)])
    return Problem(mpcc.start_from({"kappa": kappa}), trajectory, None)


def fixed_window(case: Case, start: Plan, nodes: Sequence[int]) -> Problem:
    """One step size, contact imposed at the given nodes: smooth."""
    base, trajectory, coupling = _flight(case, start)
    return Problem(base + coupling.at_nodes(nodes), trajectory, tuple(nodes))


def nearest_held(case: Case, start: Plan) -> Problem:
    """The same at the nodes nearest to a plan's contact."""
    trajectory = fixed_window(case, start, (0,)).trajectory
    return fixed_window(case, start, nearest_window(start, trajectory, case.scenario.kappa_init))


def phases(case: Case, start: Plan) -> Problem:
    """Approach, contact and leave with own step sizes, contact imposed on the contact phase: smooth.

    The contact lasts `contact_seconds`, or kappa_init - 1 average steps, so that it means the same as in
    the paper's form; for kappa_init = 1 it is one node between approach and leave.
    """
    grid = phase_grid(case, start.travel_time)
    base, trajectory = case.dynamics.transcribe(case.scenario, case.model, grid)
    coupling = _coupling(case, trajectory)
    nodes = tuple(grid.nodes("contact")) if len(grid.phases) == 3 else (grid.phases[0].intervals,)
    mpcc = base.start_from(trajectory.encode(start)) + coupling.at_nodes(nodes)
    if len(grid.phases) == 3 and case.scenario.contact_seconds is None:
        mpcc += _average_steps(grid, case.scenario.kappa_init - 1)
    return Problem(mpcc, trajectory, nodes)


def phase_grid(case: Case, travel_time: float) -> Grid:
    """Time axis of the three phases, guessed from a travel time in s and the scenario's contact guess."""
    scenario = case.scenario
    seconds = scenario.contact_seconds
    longest = scenario.travel_time[1]
    inside = scenario.kappa_init if (scenario.kappa_init > 1 or seconds) else 0
    approach = (scenario.intervals - inside) // 2
    before = Phase("approach", approach, SHORTEST, longest, scenario.contact_guess * travel_time)
    after = Phase(
        "leave", scenario.intervals - inside - approach, SHORTEST, longest, travel_time - before.guess
    )
    if not inside:
        return Grid((before, after))
    guess = (scenario.kappa_init - 1) * travel_time / scenario.intervals if seconds is None else seconds
    low, high = (SHORTEST, longest) if seconds is None else (seconds, seconds)
    return Grid((before, Phase("contact", inside, low, high, guess), after))


def nearest_window(plan: Plan, trajectory: Trajectory, count: int) -> tuple[int, ...]:
    """The `count` consecutive nodes of a one-phase grid whose middle is nearest to the plan's contact."""
    claimed = plan.time[plan.progress > 0.5 * plan.progress.max()]
    middle = (claimed[0] + claimed[-1]) / 2
    time = trajectory.grid.time_weights @ trajectory.encode(plan)["T"].ravel()
    last = trajectory.grid.intervals - count
    first = int(np.argmin(np.abs((time[: last + 1] + time[count - 1 : count + last]) / 2 - middle)))
    return tuple(range(first, first + count))


def _flight(case: Case, start: Plan) -> tuple[Mpcc, Trajectory, Coupling]:
    scenario = case.scenario
    grid = Grid((Phase("flight", scenario.intervals, *scenario.travel_time, start.travel_time),))
    base, trajectory = case.dynamics.transcribe(scenario, case.model, grid)
    return base.start_from(trajectory.encode(start)), trajectory, _coupling(case, trajectory)


def _coupling(case: Case, trajectory: Trajectory) -> Coupling:
    scenario = case.scenario
    return Coupling(scenario.contacts, case.model, scenario.target, trajectory, scenario.contact_margin)


def _average_steps(grid: Grid, steps: int) -> Mpcc:
    """T_contact = steps * t_N / N."""
    duration = ca.SX.sym("T", len(grid.phases))
    p = ca.SX.sym("p", 1)
    rest = duration[1] - p * ca.sum1(duration)
    function = ca.Function("contact_duration", [duration, p, ca.SX.sym("sigma")], [rest])
    share, zero = np.array([[steps / grid.intervals]]), np.zeros((1, 1))
    return Mpcc((), (Block("contact_duration", function, (durations(grid, 1),), share, zero, zero, "s"),))
