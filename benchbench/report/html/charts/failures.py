"""How runs end."""

from __future__ import annotations

import pandas as pd

from benchbench.report.html.charts.chart import Chart, bars, counting, wrapped
from benchbench.report.style import GOOD
from benchbench.storage.status import Status

# Chosen one after the other, each as far as can be from those before, also as red-green blind readers see them (tests/test_colours.py).
COLORS = dict(
    zip(
        Status,
        (GOOD, "#E69F00", "#D55E00", "#0DB1F2", "#0D4EC1", "#0D2E5F", "#6F0D0D", "#D1905F", "#E2E27F", "#4E90A0", "#2EC1A0", "#7FF2B1", "#0D0DF2"),
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
    counting(made, "xaxis", float(table.sum(axis=1).max()))
    return Chart("How the runs ended", text, made)
