"""What every kind of scenario must answer: ends, path and grid, how it is posed, bounded, certified and drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from benchbench.certificate.bound import lower_bound
from benchbench.certificate.certify import certify
from benchbench.conformance.checks.require import close, require
from benchbench.formulation import forms
from benchbench.ground.errors import IncompatibleCase
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.validate import validate
from benchbench.report.picture import figure

ROUNDING = 1e-9
"""In m, rad and their rates."""


def check_ends(case: Case) -> None:
    """Start and end are configurations of the vehicle within its limits, and the end is one at which a flight may end."""
    scenario, model = case.scenario, case.model
    box, last = scenario.limits(model), scenario.ends(model)
    points = {"start": scenario.start_point(model), "end": scenario.end_point(model)}
    for where, point in points.items():
        require(point.shape == box.lower.shape, f"{where}_point has shape {point.shape}")
        inside = np.all((box.lower - ROUNDING <= point) & (point <= box.upper + ROUNDING))
        require(inside, f"{where}_point is outside the limits")
    require(scenario.start_rates(model).shape == model.velocity.lower.shape, "start_rates has another shape")
    require(last.lower_q.shape == last.upper_q.shape == box.lower.shape, "ends: q has another shape")
    require(
        last.lower_v.shape == last.upper_v.shape == model.velocity.lower.shape, "ends: v has another shape"
    )
    for low, high in ((last.lower_q, last.upper_q), (last.lower_v, last.upper_v)):
        require(np.all(low <= high), "ends: a lower bound is above the upper one")
    near = (last.lower_q - ROUNDING <= points["end"]) & (points["end"] <= last.upper_q + ROUNDING)
    require(np.all(near), "no flight may end at end_point")


def check_path(case: Case) -> None:
    """Metres of the nominal path run from 0 to the same length, whatever the number of nodes."""
    for nodes in (2, 11, case.scenario.grid_intervals + 1):
        flown = case.scenario.flown(case.model, nodes)
        require(flown.shape == (nodes,), f"flown has shape {flown.shape} for {nodes} nodes")
        require(flown[0] == 0 and np.all(np.diff(flown) >= 0), "flown does not grow from 0")
        close(flown[-1], case.scenario.flown(case.model, 2)[-1], ROUNDING, "length of the path")


def check_grid(case: Case) -> None:
    """Another grid is another scenario with the same ends, or none."""
    scenario, model = case.scenario, case.model
    before = scenario.grid_intervals
    other = scenario.on_grid(before + 8)
    require(scenario.grid_intervals == before, "on_grid changes the scenario itself")
    if other is not None:
        require(before < other.grid_intervals <= before + 16, "on_grid gives another number of intervals")
        close(other.end_point(model), scenario.end_point(model), ROUNDING, "end on another grid")


def check_forms(case: Case) -> None:
    """It is posed as phases from the plain start, and in the other forms or not at all; what it solves can be read."""
    start = posing.line(case)
    for form in (forms.phases, forms.held, forms.free):
        try:
            problem = form(case.scenario, case, start)
        except IncompatibleCase:
            require(form is not forms.phases, "cannot be posed as phases, which every strategy starts with")
            continue
        plan = problem.decode(problem.mpcc.split(problem.mpcc.guess))
        require(plan.intervals == case.scenario.grid_intervals, "the problem has another number of intervals")
        close(
            plan.configuration[0], case.scenario.start_point(case.model), ROUNDING, "start of what is decoded"
        )
        require(set(plan.stop_names) == set(case.scenario.itinerary.claimed), "claims other stops")


def check_bound(case: Case) -> None:
    """The case is accepted, and nothing is proved that its travel times contradict."""
    validate(case)
    bound = lower_bound(case.scenario, case.model, case.model.plant())
    require(0.0 <= bound <= case.scenario.travel_time[1], f"lower bound of {bound} s")


def check_certificate(case: Case) -> None:
    """A straight line at hover that starts elsewhere is judged, and rejected with its reasons."""
    line = posing.line(case)
    far = replace(line, configuration=line.configuration + 0.5)
    found = certify(far, case.scenario, case.model, case.limits)
    broken = {check.name for check in found.checks if not check.ok}
    require(not found.certified and len(found.reasons) > 0, "a plan from elsewhere is certified")
    require("planned_start" in broken, "that a plan starts elsewhere is not told")


def check_picture(case: Case) -> None:
    """A plan of it is drawn."""
    drawn = figure(posing.line(case), case.scenario, case.model, None, "conformance", "NOT certified")
    require(isinstance(drawn, Figure), "its picture is no figure")


CHECKS = (
    check_ends, check_path, check_grid, check_forms, check_bound, check_certificate, check_picture,
)  # fmt: skip
