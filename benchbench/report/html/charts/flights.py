"""What success costs: the share of the flights of plans that hand over, against travel time."""

from __future__ import annotations

import pandas as pd
import plotly.graph_objects as go

from benchbench.analysis.front import candidate, front
from benchbench.report.html.charts.chart import SYMBOLS, Chart, figure
from benchbench.report.style import CURVES

HOW = ("scenario", "residual", "mismatch")
"""What tells flights apart that are not compared."""


def flown(runs: pd.DataFrame) -> bool:
    """Whether any plan was flown."""
    return bool((runs.flights.fillna(0) > 0).any())


def chart(runs: pd.DataFrame) -> Chart:
    """Draw a point for each plan that was flown, with the 95 % Wilson interval of its rate, and the front of each group."""
    some = runs[runs.flights.fillna(0) > 0]
    text = (
        "Each point is a certified plan, flown many times in closed loop under declared mismatch (docs/flight.md): its travel time, "
        "and the share of its flights that hand over. Bars are 95 % Wilson score intervals; the line joins those that no "
        "other plan of their colour beats in both."
    )
    groups = [(", ".join(map(str, name)), rows) for name, rows in some.groupby([*HOW], sort=False)]
    made = figure("travel time [s]", "flights that succeed [%]", names=[name for name, _ in groups])
    for k, (name, rows) in enumerate(groups):
        color = CURVES[k % len(CURVES)]
        _front(made, rows, name, color)
        _points(made, rows, name, color, SYMBOLS[k % len(SYMBOLS)])
    made.update_yaxes(range=[-4, 104])
    return Chart("Success in flight against travel time", text, made)


def _points(made: go.Figure, rows: pd.DataFrame, name: str, color: str, symbol: str) -> None:
    share = 100 * rows.flights_succeeded.astype(float) / rows.flights.astype(float)
    made.add_scatter(
        x=list(rows.travel_time_s), y=list(share), mode="markers", name=name, cliponaxis=False, legendgroup=name,
        marker={"color": color, "size": 9, "symbol": symbol},
        error_y={
            "type": "data", "symmetric": False, "color": color, "thickness": 1,
            "array": list(100 * rows.flights_high - share), "arrayminus": list(share - 100 * rows.flights_low),
        },
        text=[
            f"{good} of {count}, {100 * low:.1f} % proved<br>{what}"
            for good, count, low, what in zip(rows.flights_succeeded, rows.flights, rows.flights_low_exact, rows.problem, strict=True)
        ],
        hovertemplate="%{x:.4f} s: %{text}<extra></extra>",
    )  # fmt: skip


def _front(made: go.Figure, rows: pd.DataFrame, name: str, color: str) -> None:
    found = [
        one for row in rows.to_dict("records") if (one := candidate((), {str(k): v for k, v in row.items()}))
    ]
    best = front(found)
    made.add_scatter(
        x=[one.travel_time for one in best], y=[100 * one.rate for one in best], mode="lines", showlegend=False,
        line={"color": color, "width": 1.5, "shape": "hv"}, hoverinfo="skip", legendgroup=name,
    )  # fmt: skip
