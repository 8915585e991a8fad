"""Where the CPU time goes: by kind of work, and by step of the solution."""

from __future__ import annotations

import pandas as pd

from benchbench.analysis.costs import by_step, by_work
from benchbench.report.html.charts.chart import Chart, bars, wrapped
from benchbench.report.style import CURVES

BLUE, RED, GREEN, PINK, YELLOW, BLACK = CURVES
COLORS = {
    "assembly": BLUE, "derivatives": GREEN, "build": "#8FB9D3", "function evaluations": PINK, "linear algebra, rest": YELLOW,
    "solver": "#E8B8A0", "certificate": BLACK, "guess": BLUE, "homotopy": YELLOW, "last solve": RED,
}  # fmt: skip


def work(runs: pd.DataFrame) -> Chart:
    """Draw the mean CPU time of each kind of work, per method."""
    text = (
        "Mean CPU time of a run by kind of work: assembling the problem, its derivatives (taken, compiled or read from "
        "the cache), function evaluations and the rest inside the solver (linear algebra, its own steps), the "
        "certificate. Some solvers do not tell the two apart."
    )
    return _chart("Where the time goes", text, runs, by_work(runs))


def steps(runs: pd.DataFrame) -> Chart:
    """Draw the mean CPU time in the solver of guess, homotopy and last solve, per method."""
    text = (
        "Mean CPU time inside the solver by step: solves that only make the initial guess, those of the homotopy "
        "before the last one, and the last one."
    )
    return _chart("Where the solver's time goes", text, runs, by_step(runs))


def _chart(title: str, text: str, runs: pd.DataFrame, parts: pd.DataFrame) -> Chart:
    means = parts.groupby(runs.method, sort=False).mean().dropna(how="all")
    means = means.loc[:, means.gt(0).any()]
    if means.empty:
        return Chart(title, text, missing="No run has recorded its CPU time.")
    methods = [str(method) for method in means.index]
    made = bars("CPU time [s]", methods, map(str, means.columns))
    for name in means.columns:
        made.add_bar(
            y=[wrapped(method) for method in methods], x=means[name], name=name, orientation="h", marker={"color": COLORS[name]},
            hovertemplate="%{x:.3g} s<extra>" + name + "</extra>",
        )  # fmt: skip
    return Chart(title, text, made)
