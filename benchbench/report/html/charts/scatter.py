"""Scatter plots of runs: filled where certified, open where not."""

from __future__ import annotations

import pandas as pd
import plotly.graph_objects as go

from benchbench.report.html.charts.chart import Style, Styles, line


def add_runs(made: go.Figure, runs: pd.DataFrame, x: str, y: str, styles: Styles) -> None:
    """Add the runs of each method and series; points of a series (column `series`) are joined by a line."""
    for method in runs.method.unique():
        of_method = runs[runs.method == method]
        for i, series in enumerate(of_method.series.unique()):
            some = of_method[of_method.series == series].sort_values(x)
            made.add_scatter(**_trace(method, some, x, y, styles[method], i == 0))


def _trace(method: str, some: pd.DataFrame, x: str, y: str, style: Style, first: bool) -> dict[str, object]:
    symbols = [style.symbol if ok else f"{style.symbol}-open" for ok in some.certified.fillna(False)]
    return {
        "x": some[x].astype(float), "y": some[y].astype(float), "name": method, "legendgroup": method,
        "showlegend": first, "mode": "lines+markers", "line": {**line(style), "width": 1},
        "marker": {"symbol": symbols, "size": 9, "color": style.color},
        "customdata": some[["problem", "status"]].astype(str).to_numpy(),
        "hovertemplate": "%{customdata[0]}<br>%{customdata[1]}<br>%{x:.4g}, %{y:.4g}",
    }  # fmt: skip
