"""What the scenario's own cost terms come to, integrated over the replay, and whether the planner's sum agrees."""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import Checks, at_most
from benchbench.certificate.evidence import Evidence
from benchbench.ground.arrays import Array
from benchbench.ocp.plan import bezier
from benchbench.ocp.touching import motors


def spent(evidence: Evidence) -> dict[str, float]:
    """Return the integral of each term over the replay in s, by name: Simpson's rule in every interval."""
    plan, flight, plant = evidence.plan, evidence.flight, evidence.plant
    if not evidence.scenario.costs:
        return {}
    samples = (len(flight.time) - 1) // plan.intervals
    at = flight.nodes[:-1, None] + np.arange(samples + 1)
    u = bezier(plan.input_pieces[:, None], np.arange(samples + 1) / samples)
    state = [
        np.reshape(values, (at.size, -1)) for values in (flight.configuration[at], flight.velocity[at], u)
    ]
    return {
        name: _integral(np.reshape(term.spent(plant, *state), at.shape), np.diff(plan.time))
        for name, term in evidence.scenario.costs.items()
    }


def effort(evidence: Evidence) -> float:
    """Return c_u times the integral of |u - u_ref|^2 in s, of the inputs as the plan interpolates them."""
    s = np.linspace(0.0, 1.0, 11)
    off = bezier(evidence.plan.input_pieces[:, None], s) - evidence.model.hover()
    return evidence.scenario.input_cost * _integral(
        np.sum(off[..., motors(evidence.model)] ** 2, axis=2), np.diff(evidence.plan.time)
    )


def objective(evidence: Evidence) -> Checks:
    """Check the planner's objective against travel time, effort, own terms and rewards, counted again; asked where there are terms."""
    solved, limits, scenario = evidence.residuals, evidence.limits, evidence.scenario
    if solved is None or not scenario.costs:
        return
    plan, stops = evidence.plan, scenario.itinerary.stops
    made = {
        name
        for name, progress in zip(plan.stop_names, plan.progress_by_stop.T, strict=True)
        if progress.max() > limits.contact_claim
    }
    reward = sum(stop.reward or 0.0 for stop in stops if stop.name in made)
    found = plan.travel_time + effort(evidence) + sum(spent(evidence).values()) - reward
    what = f"the planner's objective is {solved.cost:.6g} s, counted again on the replay {found:.6g} s: the difference"
    allowed = limits.objective * abs(found)
    yield at_most("objective", what, abs(solved.cost - found), allowed, "s", advice=advice.FINER)


def _integral(values: Array, steps: Array) -> float:
    """Composite Simpson rule of values (N, 2 m + 1) over intervals of `steps` (N,) s."""
    weights = np.full(values.shape[1], 2.0)
    weights[1::2] = 4.0
    weights[[0, -1]] = 1.0
    return float(steps @ (values @ weights) / (3 * (values.shape[1] - 1)))
