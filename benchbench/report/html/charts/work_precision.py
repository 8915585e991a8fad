"""Work against precision: what a smaller error costs, of one interval and of the certified travel time."""

from __future__ import annotations

import pandas as pd

from benchbench.analysis.reference_times import travel_time_errors
from benchbench.report.html.charts.chart import Chart, Styles, figure, logarithmic
from benchbench.report.html.charts.scatter import add_runs
from benchbench.report.html.room import drawn

ERROR, WORK, TIME_ERROR = "replay_defect_position_m", "solve_s", "travel_time_error"
LEAST = 1e-7
"""Smallest relative error of a travel time that is drawn: the accuracy of the best solves."""


def chart(runs: pd.DataFrame, styles: Styles) -> Chart:
    """Draw CPU time over the position error of one interval; a line joins the grids of one task."""
    title = "Work and precision"
    text = (
        "CPU time in the solver over the largest position error of one interval, as our replay measures it. "
        "Towards the lower left is better. Filled: certified; open: a plan that is not certified. A line joins the "
        "grids (N) of one task."
    )
    known = runs[(runs[ERROR] > 0) & (runs[WORK] > 0)]
    if known.empty:
        return Chart(title, text, missing="No run has a plan whose error was measured.")
    return _chart(title, text, known, (ERROR, "replay error of one interval [m]"), styles)


def travel_time(runs: pd.DataFrame, styles: Styles) -> Chart:
    """Draw CPU time over the error of the certified travel time; a line joins the grids of one task."""
    title = "Work and precision of the travel time"
    text = (
        "CPU time in the solver over the relative distance of the certified travel time from the best one of the task on the finest grid. "
        f"Certified plans only; what is nearer than {LEAST:g} stands at the left edge, such as that best one itself. Towards the lower left is better."
    )
    known = runs.assign(**{TIME_ERROR: travel_time_errors(runs).clip(lower=LEAST)})
    known = known[known[TIME_ERROR].notna() & (known[WORK] > 0)]
    if known.empty or known.groupby([known.task, known.kappa_init.map(str)]).size().max() < 2:
        return Chart(title, text, missing="No task has two certified plans.")
    return _chart(title, text, known, (TIME_ERROR, "relative error of the travel time"), styles)


def _chart(title: str, text: str, known: pd.DataFrame, error: tuple[str, str], styles: Styles) -> Chart:
    """Draw CPU time over a column of errors, which has a label; both are above zero."""
    known, said = drawn(known)
    made = figure(error[1], "CPU time [s]", names=known.method.unique())
    add_runs(made, known.assign(series=known.task + known.kappa_init.map(str)), error[0], WORK, styles)
    logarithmic(made, "xaxis", known[error[0]])
    logarithmic(made, "yaxis", known[WORK])
    return Chart(title, text + said, made)
