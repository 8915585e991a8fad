"""Work against precision: what a smaller certified error costs."""

from __future__ import annotations

import pandas as pd

from benchbench.report.html.charts.chart import Chart, Styles, figure, logarithmic
from benchbench.report.html.charts.scatter import add_runs
from benchbench.report.html.room import drawn

ERROR, WORK = "replay_defect_position_m", "solve_s"


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
    known, said = drawn(known)
    made = figure("replay error of one interval [m]", "CPU time [s]", names=known.method.unique())
    add_runs(made, known.assign(series=known.task + known.kappa_init.astype(str)), ERROR, WORK, styles)
    logarithmic(made, "xaxis", known[ERROR])
    logarithmic(made, "yaxis", known[WORK])
    return Chart(title, text + said, made)
