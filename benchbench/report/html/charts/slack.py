"""What slack costs: travel time over a limit of a contact, or a tolerance, that runs vary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from benchbench.analysis.varied import slacks, varied
from benchbench.report.html.charts.chart import DASHES, SYMBOLS, Chart, figure
from benchbench.report.style import CURVES

MOST = 6
"""Fields that are drawn, and lines of each."""
PAPER = {"scenario.contacts.position.limit": "nu_max", "scenario.contacts.velocity.limit": "c_limit"}
"""What the paper calls them."""


def charts(runs: pd.DataFrame, settings: Sequence[Mapping[str, Any] | None]) -> Iterator[Chart]:
    """Draw a chart for each field by which runs of otherwise the same task differ; none where no run varies any."""
    for field in slacks(settings)[:MOST]:
        found = varied(runs, settings, field)
        if len(found):
            yield _chart(found, field)


def _chart(found: pd.DataFrame, field: str) -> Chart:
    name = field.removeprefix("scenario.contacts.").removeprefix("scenario.")
    name = f"{PAPER[field]} ({name})" if field in PAPER else name
    groups = list(found.groupby("rest", sort=False))
    text = f"Travel time of the fastest certified plans over {field}; a line joins runs that differ in nothing else of task and method."
    labels = [f"{some.scenario.iloc[0]}, {some.method.iloc[0]}" for _, some in groups]
    more = f" {MOST} of {len(groups)} lines are drawn." if len(groups) > MOST else ""
    made = figure(name, "travel time [s]", names=labels[:MOST])
    for i, ((_, some), label) in enumerate(zip(groups[:MOST], labels, strict=False)):
        color = CURVES[i % len(CURVES)]
        made.add_scatter(
            x=some.value, y=some.travel_time_s, mode="lines+markers", name=label, hovertemplate="%{x:.4g}: %{y:.4f} s",
            line={"color": color, "width": 1.5, "dash": DASHES[i % len(DASHES)]}, marker={"color": color, "size": 8, "symbol": SYMBOLS[i % len(SYMBOLS)]},
        )  # fmt: skip
    made.update_layout(showlegend=True)
    return Chart(f"What {name} costs", text + more, made)
