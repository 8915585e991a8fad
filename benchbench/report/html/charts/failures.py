"""How runs end."""

from __future__ import annotations

import pandas as pd

from benchbench.report.html.charts.chart import Chart, bars, wrapped
from benchbench.report.style import GOOD
from benchbench.storage.status import Status

COLORS = dict(
    zip(
        Status,
        (GOOD, "#E69F00", "#D55E00", "#CC79A7", "#F0A5C8", "#8A5A9E", "#1A1A1A", "#5B4636", "#7FB7BE", "#9A9A9A", "#C4C4C4", "#D9C77E", "#B22222"),
        strict=True,
    )
)  # fmt: skip


def chart(runs: pd.DataFrame) -> Chart:
    """Count the outcomes of each method's runs."""
    text = (
        "Number of runs by outcome; what each outcome means and what helps stands in the list of runs below."
    )
    counts = (
        runs.assign(status=runs.status.fillna("unknown")).groupby(["method", "status"], sort=False).size()
    )
    table = counts.unstack(fill_value=0)
    methods = [str(method) for method in table.index]
    made = bars("runs", methods, map(str, table.columns))
    for status in [*Status, "unknown"]:
        if status in table:
            made.add_bar(
                y=[wrapped(method) for method in methods], x=table[status], name=str(status).replace("_", " "), orientation="h",
                marker={"color": COLORS.get(status, "#DDDDDD")},
                hovertemplate="%{x} runs<extra>" + str(status) + "</extra>",
            )  # fmt: skip
    made.update_xaxes(tickformat="d")
    return Chart("How the runs ended", text, made)
