"""Scatter plots of runs: filled where certified, open where not."""

from __future__ import annotations

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from benchbench.report.html.charts.chart import Style, Styles, line

SHARED, MOST_NAMES = 0.06, 12
"""Share of the height within which the names of lines would hide each other; how many are written."""
ROOM_LEFT, ROOM_RIGHT = 0.06, 0.6
"""Room beside the lines, the right for their names, as shares of their width."""


def add_runs(made: go.Figure, runs: pd.DataFrame, x: str, y: str, styles: Styles) -> None:
    """Add the runs of each method and series; points of a series (column `series`) are joined by a line."""
    narrow = runs[[x, y, "method", "series", "certified", "problem", "status"]]
    groups = narrow.groupby("method", sort=False)
    made.add_traces([_trace(str(method), some, x, y, styles[str(method)]) for method, some in groups])
    made.update_layout(showlegend=True)  # of one method, too


def name_tasks(made: go.Figure, runs: pd.DataFrame, x: str, y: str) -> None:
    """Write at the right end of the lines which task they are of, where there are several; those that end near each other share a line."""
    if runs.task.nunique() < 2:
        return
    last = runs.sort_values(x).groupby("task", sort=False).tail(1)
    ends = sorted(zip(last[y].astype(float), last[x].astype(float), last.task.astype(str), strict=True))
    near = SHARED * (float(runs[y].max()) - float(runs[y].min()) or 1.0)
    places: list[tuple[float, float, list[str]]] = []
    for height, end, task in ends[:MOST_NAMES]:
        if places and height - places[-1][0] < near:
            places[-1] = (places[-1][0], max(places[-1][1], end), [*places[-1][2], task])
        else:
            places.append((height, end, [task]))
    for height, end, tasks in places:
        made.add_annotation(
            x=end,
            y=height,
            text="<br>".join(tasks),
            showarrow=False,
            xanchor="left",
            xshift=8,
            align="left",
            font={"size": 11},
            name="task",
        )
    low, high = float(runs[x].min()), float(runs[x].max())
    width = high - low or 1.0
    made.update_xaxes(range=[low - ROOM_LEFT * width, high + ROOM_RIGHT * width])


def _trace(method: str, some: pd.DataFrame, x: str, y: str, style: Style) -> go.Scatter:
    """All of a method as one trace, with a gap between two series: many small traces take long."""
    some = some.sort_values(["series", x], kind="stable")
    gaps = np.flatnonzero(some.series.to_numpy()[1:] != some.series.to_numpy()[:-1]) + 1
    symbols = [style.symbol if ok else f"{style.symbol}-open" for ok in some.certified.fillna(False)]
    told = {
        "x": np.insert(some[x].to_numpy(float), gaps, np.nan), "y": np.insert(some[y].to_numpy(float), gaps, np.nan),
        "name": method, "mode": "lines+markers", "line": {**line(style), "width": 1},
        "marker": {"symbol": np.insert(np.array(symbols, object), gaps, style.symbol).tolist(), "size": 9, "color": style.color},
        "customdata": np.insert(some[["problem", "status"]].astype(str).to_numpy(object), gaps, "", axis=0).tolist(),
        "hovertemplate": "%{customdata[0]}<br>%{customdata[1]}<br>%{x:.4g}, %{y:.4g}",
    }  # fmt: skip
    return go.Scatter(told)
