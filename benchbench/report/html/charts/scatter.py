"""Scatter plots of runs: filled where certified, open where not."""

from __future__ import annotations

import pandas as pd
import plotly.graph_objects as go

from benchbench.report.html.charts.chart import Style, Styles, line


def add_runs(made: go.Figure, runs: pd.DataFrame, x: str, y: str, styles: Styles) -> None:
    """Add the runs of each method and series; points of a series (column `series`) are joined by a line."""
    narrow = runs[[x, y, "method", "series", "certified", "problem", "status"]]
    seen: set[str] = set()
    traces = []
    for (named, _), some in narrow.groupby(["method", "series"], sort=False):
        method = str(named)
        traces.append(_trace(method, some.sort_values(x), x, y, styles[method], method not in seen))
        seen.add(method)
    made.add_traces(traces)


def _trace(method: str, some: pd.DataFrame, x: str, y: str, style: Style, first: bool) -> go.Scatter:
    symbols = [style.symbol if ok else f"{style.symbol}-open" for ok in some.certified.fillna(False)]
    told = {
        "x": some[x].astype(float), "y": some[y].astype(float), "name": method, "legendgroup": method,
        "showlegend": first, "mode": "lines+markers", "line": {**line(style), "width": 1},
        "marker": {"symbol": symbols, "size": 9, "color": style.color},
        "customdata": some[["problem", "status"]].astype(str).to_numpy(),
        "hovertemplate": "%{customdata[0]}<br>%{customdata[1]}<br>%{x:.4g}, %{y:.4g}",
    }  # fmt: skip
    return go.Scatter(told)
