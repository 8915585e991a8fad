"""What success costs: travel time of plans against the share of their flights that hand over."""

from __future__ import annotations

import pandas as pd

from benchbench.report.html.charts.chart import Chart, figure
from benchbench.report.style import CURVES

HOW = ("residual", "mismatch")
"""What tells flights of a plan apart."""


def flown(runs: pd.DataFrame) -> bool:
    """Whether any plan was flown."""
    return bool((runs.flights.fillna(0) > 0).any())


def chart(runs: pd.DataFrame) -> Chart:
    """Draw a point for each plan that was flown, with the 95 % Wilson interval of its rate."""
    some = runs[runs.flights.fillna(0) > 0]
    text = (
        "Each point is a certified plan, flown many times in closed loop under declared mismatch (docs/flight.md): its travel time, "
        "and the share of its flights that hand over. Bars are 95 % Wilson score intervals."
    )
    groups = list(some.groupby([*HOW], sort=False))
    made = figure(
        "flights that succeed [%]", "travel time [s]", names=[", ".join(map(str, name)) for name, _ in groups]
    )
    for k, (name, rows) in enumerate(groups):
        share = 100 * rows.flights_succeeded.astype(float) / rows.flights.astype(float)
        color = CURVES[k % len(CURVES)]
        made.add_scatter(
            x=list(share), y=list(rows.travel_time_s), mode="markers", name=", ".join(map(str, name)),
            cliponaxis=False, marker={"color": color, "size": 10},
            error_x={
                "type": "data", "symmetric": False, "color": color, "thickness": 1.5,
                "array": list(100 * rows.flights_high - share), "arrayminus": list(share - 100 * rows.flights_low),
            },
            text=[f"{s} of {n}, {what}" for s, n, what in zip(rows.flights_succeeded, rows.flights, rows.scenario, strict=True)],
            hovertemplate="%{text}: %{y:.3f} s<extra></extra>",
        )  # fmt: skip
    made.update_xaxes(range=[-2, 102])
    return Chart("Travel time against success in flight", text, made)
