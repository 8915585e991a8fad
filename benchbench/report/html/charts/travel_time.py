"""Travel time over the contact asked for, and over the grid."""

from __future__ import annotations

import pandas as pd

from benchbench.report.html.charts.chart import Chart, Styles, figure
from benchbench.report.html.charts.scatter import add_runs, name_tasks
from benchbench.report.html.room import drawn

AXES = {"kappa_init": "κ_init (nodes in contact)", "intervals": "N (intervals)"}
OTHER = {"kappa_init": "intervals", "intervals": "kappa_init"}


def chart(runs: pd.DataFrame, styles: Styles, over: str) -> Chart:
    """Draw the travel time over `kappa_init` or `intervals`; a line joins the runs of one task."""
    title = f"Travel time over {'κ_init' if over == 'kappa_init' else 'N'}"
    text = (
        f"Travel time of the plans; a line joins the runs of one task at one "
        f"{'N' if over == 'kappa_init' else 'κ_init'}. Filled: certified; open: not certified, so the time may be "
        "gained by breaking a limit."
    )
    known = runs[runs.travel_time_s.notna() & runs[over].notna()]
    if known.empty:
        return Chart(title, text, missing="No run has a plan.")
    known, said = drawn(known)
    made = figure(AXES[over], "travel time [s]", names=known.method.unique())
    add_runs(
        made, known.assign(series=known.task + known[OTHER[over]].map(str)), over, "travel_time_s", styles
    )
    values = sorted(known[over].astype(int).unique().tolist())
    if len(values) <= 12:
        made.update_xaxes(tickvals=values)
    if len(values) == 1:
        made.update_xaxes(range=[values[0] - 1, values[0] + 1])
    made.update_xaxes(tickformat="d")
    name_tasks(made, known, over, "travel_time_s")
    return Chart(title, text + said, made)
