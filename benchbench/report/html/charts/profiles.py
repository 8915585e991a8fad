"""Performance profile and data profile."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from benchbench.analysis.costs import comparable, cost_matrix
from benchbench.analysis.profiles import Staircase, data_profile, performance_profile
from benchbench.report.html.charts.chart import Chart, Styles, figure, line, logarithmic

LEAST = 1e-6
"""Smallest cost that counts, so that a cost of zero has a logarithm."""
LEAST_SPAN = 5.0
"""Smallest ratio of the ends of the axis, so that it has more than one label."""


def performance(runs: pd.DataFrame, styles: Styles) -> Chart:
    """Profile of the solver's CPU time."""
    title = "Performance profile"
    text = (
        "Share of problems for which a method finds a certified plan within τ times the CPU time of the fastest "
        "method (Dolan and Moré 2002). Left edge: how often it is the fastest; right edge: how often it succeeds."
    )
    costs, note = _costs(runs, "solve_s")
    if costs.empty:
        return Chart(title, text, missing=note)
    return _draw(Chart(title, text + note), performance_profile(costs), styles, "time ratio τ", start=1.0)


def data(runs: pd.DataFrame, styles: Styles) -> Chart:
    """Profile of evaluations in groups of n + 1, n unknowns."""
    title = "Data profile"
    text = (
        "Share of problems for which a method finds a certified plan within a budget of evaluations of objective, "
        "constraints and derivatives, counted in groups of n + 1 for n unknowns (Moré and Wild 2009)."
    )
    costs, note = _costs(runs, "evaluations")
    sizes = runs.groupby("problem").n_variables.median().astype(float)
    costs = costs[sizes.reindex(costs.index).notna()]
    if costs.empty:
        return Chart(title, text, missing=note or "The number of unknowns is not recorded.")
    return _draw(
        Chart(title, text + note), data_profile(costs, sizes), styles, "evaluations / (n + 1)", start=None
    )


def left_out(table: pd.DataFrame, costs: pd.DataFrame) -> str:
    """Say which methods and how many problems of a table of costs are not compared."""
    methods = ", ".join(map(str, table.columns.difference(costs.columns)))
    problems = len(table) - len(costs)
    texts = [f"{methods} (tried on few of the problems)"] if methods else []
    texts += (
        [f"{problems} problem{'s' if problems > 1 else ''} that not every method was tried on"]
        if problems
        else []
    )
    return f" Left out: {'; '.join(texts)}." if texts else ""


def _costs(runs: pd.DataFrame, column: str) -> tuple[pd.DataFrame, str]:
    """Costs of what can be compared, and what a reader must know about them."""
    table = cost_matrix(runs, column)
    costs = comparable(table).clip(lower=LEAST)
    if not np.isfinite(table.to_numpy()).any():
        return costs.iloc[:0], "No run has a certified plan, so there is no cost to compare."
    if not np.isfinite(costs.to_numpy()).any():
        return costs.iloc[
            :0
        ], "No problem that every method was tried on was solved, so nothing can be compared."
    return costs, left_out(table, costs)


def _draw(
    chart: Chart, profiles: Mapping[str, Staircase], styles: Styles, unit: str, start: float | None
) -> Chart:
    made = figure(unit, "share of problems [%]", names=profiles)
    places = np.concatenate([x for x, _ in profiles.values()])
    left = float(np.min(places)) * 0.8 if start is None else start
    right = max(float(np.max(places)) * 1.25, LEAST_SPAN * left)
    for method, (x, share) in profiles.items():
        base = [] if start is not None and len(x) and x[0] <= start else [left]
        made.add_scatter(
            x=[*base, *x, right], y=100 * np.array([*[0.0] * len(base), *share, share[-1] if len(x) else 0.0]),
            mode="lines", name=method, line={**line(styles[method]), "shape": "hv"},
            hovertemplate="%{y:.0f} % within %{x:.3g}",
        )  # fmt: skip
    logarithmic(made, "xaxis", [left, right])
    made.update_xaxes(range=np.log10([left, right]).tolist())
    made.update_yaxes(range=[-2, 103])
    made.update_layout(showlegend=True)  # of one method, too
    return Chart(chart.title, chart.text, made)
