"""Claimed and certified success rates with their Wilson intervals."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from benchbench.analysis.wilson import Rate, wilson
from benchbench.report.html.charts.chart import Chart, figure, rows_height, wrapped
from benchbench.report.style import BAD, GOOD

MARKS = {"certified": (GOOD, "circle"), "claimed": (BAD, "circle-open")}


@dataclass(frozen=True)
class Success:
    """Rates of one method: what its solver claims and what the certificate accepts."""

    method: str
    claimed: Rate
    certified: Rate


def success(runs: pd.DataFrame) -> list[Success]:
    """Count each method's runs; a run that never came to a claim counts as none."""
    return [
        Success(str(method), rate(some.claimed_success), rate(some.certified))
        for method, some in runs.groupby("method", sort=False)
    ]


def chart(runs: pd.DataFrame) -> Chart:
    """Draw both rates of every method."""
    rates = success(runs)
    text = (
        "Share of each method's runs in which the solver claims success, and in which our own checks accept the "
        "plan. Bars are 95 % Wilson score intervals."
    )
    names = [one.method for one in rates]
    made = figure("share of runs [%]", height=rows_height(names), names=MARKS)
    for kind, (color, symbol) in MARKS.items():
        found: list[Rate] = [getattr(one, kind) for one in rates]
        shares = [100 * (rate.rate or 0.0) for rate in found]
        made.add_scatter(
            x=shares, y=[names.index(name) + (0.12 if kind == "claimed" else -0.12) for name in names],
            mode="markers", name=kind, cliponaxis=False, marker={"color": color, "symbol": symbol, "size": 11, "line": {"width": 2}},
            error_x={
                "type": "data", "symmetric": False, "color": color, "thickness": 1.5,
                "array": [100 * rate.high - share for rate, share in zip(found, shares, strict=True)],
                "arrayminus": [share - 100 * rate.low for rate, share in zip(found, shares, strict=True)],
            },
            text=[f"{rate.successes} of {rate.runs}" for rate in found],
            hovertemplate="%{text}: %{x:.0f} %<extra>" + kind + "</extra>",
        )  # fmt: skip
    made.update_xaxes(range=[-2, 102])
    made.update_yaxes(
        tickvals=list(range(len(names))),
        ticktext=[wrapped(name) for name in names],
        range=[len(names) - 0.5, -0.5],
        ticks="",
        ticklabelstandoff=6,
        showgrid=False,
    )
    return Chart("Success, claimed and certified", text, made)


def rate(column: pd.Series) -> Rate:
    """Share of a column that is true; what is unknown is not."""
    return wilson(int(column.fillna(False).astype(bool).sum()), len(column))
