"""Where the CPU time goes."""

from __future__ import annotations

import pandas as pd

from benchbench.report.html.charts.chart import Chart, bars
from benchbench.report.style import CURVES
from benchbench.storage.schema import COLUMNS

PARTS = {
    c.name: c.name.removesuffix("_cpu_s").replace("_", " ") for c in COLUMNS if c.name.endswith("_cpu_s")
}
"""Every part of a run whose CPU time is recorded, and its name."""


def chart(runs: pd.DataFrame) -> Chart:
    """Draw the mean CPU time of each part, per method."""
    title = "Where the time goes"
    text = (
        "Mean CPU time of a run: building the problem (compiler included), the solver (derivatives, linear algebra "
        "and all steps of the homotopy), the certificate."
    )
    means = runs.groupby("method", sort=False)[list(PARTS)].mean().astype(float).dropna(how="all")
    if means.empty:
        return Chart(title, text, missing="No run has recorded its CPU time.")
    made = bars("CPU time [s]", len(means), PARTS.values())
    for i, (part, name) in enumerate(PARTS.items()):
        made.add_bar(
            y=means.index.astype(str), x=means[part], name=name, orientation="h", marker={"color": CURVES[i % 6]},
            hovertemplate="%{x:.3g} s<extra>" + name + "</extra>",
        )  # fmt: skip
    return Chart(title, text, made)
