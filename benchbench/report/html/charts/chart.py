"""What every chart has in common: its words, its look, one style per method."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10
from textwrap import wrap

import plotly.graph_objects as go

from benchbench.report.style import CURVES, FAINT, INK

DASHES = ("solid", "dash", "dot", "dashdot")
SYMBOLS = ("circle", "square", "diamond", "triangle-up")
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
GRID = "#E6E6E6"
CLEAR = "rgba(0,0,0,0)"
HEIGHT_PX, ROW_PX, LINE_PX, LEGEND_ROW_PX = 330, 34, 17, 22
KEY_LETTERS, LEGEND_LETTERS = 7, 52
"""Width of a legend's key and of a legend on a narrow page, in letters."""
NAME_LETTERS = 22
"""Longest line of a method's name beside a bar, so that a narrow page has room for the bar."""


@dataclass(frozen=True)
class Chart:
    """A figure with its title and how to read it; `missing` says why there is no figure."""

    title: str
    text: str
    figure: go.Figure | None = None
    missing: str = ""


@dataclass(frozen=True)
class Style:
    """How a method is drawn everywhere in the report."""

    color: str
    dash: str
    symbol: str


Styles = Mapping[str, Style]


def styles(methods: Iterable[str]) -> dict[str, Style]:
    """Give each method a style of its own; neighbours differ in colour and symbol, all in colour and dash."""
    count = len(CURVES)
    return {
        method: Style(CURVES[i % count], DASHES[i // count % len(DASHES)], SYMBOLS[i % len(SYMBOLS)])
        for i, method in enumerate(dict.fromkeys(methods))
    }


def figure(x: str = "", y: str = "", height: int = HEIGHT_PX, names: Iterable[str] = ()) -> go.Figure:
    """Return an empty figure in the report's look with axis titles, and room for a legend of these names."""
    widths = [len(name) + KEY_LETTERS for name in names]  # all entries get the width of the longest
    rows = ceil(len(widths) / max(LEGEND_LETTERS // max(widths, default=1), 1))
    bottom = 52 + LEGEND_ROW_PX * rows
    made = go.Figure()
    axis = {
        "gridcolor": GRID, "zeroline": False, "linecolor": FAINT, "showline": True, "ticks": "outside",
        "tickcolor": FAINT, "automargin": True,
    }  # fmt: skip
    made.update_layout(
        template="none", height=height + LEGEND_ROW_PX * rows, font={"family": FONT, "size": 13, "color": INK},
        margin={"l": 56, "r": 16, "t": 26, "b": bottom}, xaxis={**axis, "title": {"text": x, "standoff": 8}},
        yaxis={**axis, "title": {"text": y, "standoff": 8}}, paper_bgcolor=CLEAR, plot_bgcolor=CLEAR,
        legend={
            "orientation": "h", "yref": "container", "y": 0.0, "yanchor": "bottom", "xref": "container", "x": 0.0, "xanchor": "left",
            "traceorder": "normal",
        },
        modebar={"bgcolor": CLEAR, "color": FAINT, "activecolor": INK}, hovermode="closest",
        hoverlabel={"font": {"family": FONT}},
    )  # fmt: skip
    return made


def wrapped(name: str) -> str:
    """A method's name in lines that leave room for its bar."""
    return "<br>".join(wrap(name, NAME_LETTERS, break_long_words=False))


def rows_height(methods: Sequence[str]) -> int:
    """Height in px of a figure with a row for each method, whose names are wrapped."""
    lines = max((wrapped(name).count("<br>") + 1 for name in methods), default=1)
    return max(ROW_PX, LINE_PX * lines + 8) * len(methods) + 90


def bars(x: str, methods: Sequence[str], names: Iterable[str]) -> go.Figure:
    """Return an empty figure for one horizontal bar per method, at its `wrapped` name, of the named parts."""
    made = figure(x, height=rows_height(methods), names=names)
    made.update_layout(barmode="stack", bargap=0.35)
    made.update_xaxes(rangemode="tozero")
    made.update_yaxes(autorange="reversed", ticks="", showgrid=False, ticklabelstandoff=6)
    return made


def line(style: Style) -> dict[str, object]:
    """The line of a method."""
    return {"color": style.color, "dash": style.dash, "width": 2}


def counting(made: go.Figure, axis: str, most: float) -> None:
    """Make an axis from 0 count: whole numbers only, however few there are."""
    step = next(s * 10**p for p in range(12) for s in (1, 2, 5) if most <= 8 * s * 10**p)
    made.update_layout(
        {axis: {"tickmode": "linear", "tick0": 0, "dtick": step, "tickformat": "d", "rangemode": "tozero"}}
    )


def logarithmic(made: go.Figure, axis: str, values: Iterable[float]) -> None:
    """Make an axis logarithmic, with labels at powers of ten, or at 1, 2, 5 where the values span few of them."""
    known = [value for value in values if value > 0]
    made.update_layout({axis: {"type": "log", "dtick": 1, "exponentformat": "power"}})
    made.update_layout({axis: {"minor": {"ticks": "outside", "dtick": "D1", "showgrid": False}}})
    if known and max(known) < 100 * min(known):
        lowest, highest = floor(log10(min(known))), ceil(log10(max(known)))
        ticks = [digit * 10.0**power for power in range(lowest, highest + 1) for digit in (1, 2, 5)]
        made.update_layout({axis: {"tickvals": ticks, "ticktext": [f"{tick:.3g}" for tick in ticks]}})
