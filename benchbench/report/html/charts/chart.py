"""What every chart has in common: its words, its look, one style per method."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import plotly.graph_objects as go

from benchbench.report.style import CURVES, FAINT, INK

DASHES = ("solid", "dash", "dot", "dashdot")
SYMBOLS = ("circle", "square", "diamond", "triangle-up")
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
GRID = "#E6E6E6"
HEIGHT_PX, ROW_PX = 380, 34


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
    """Give each method a style of its own; colours repeat after six, with another dash and symbol."""
    count = len(CURVES)
    return {
        method: Style(CURVES[i % count], DASHES[i // count % 4], SYMBOLS[i // count % 4])
        for i, method in enumerate(dict.fromkeys(methods))
    }


def figure(x: str = "", y: str = "", height: int = HEIGHT_PX) -> go.Figure:
    """Return an empty figure in the report's look with axis titles."""
    made = go.Figure()
    axis = {
        "gridcolor": GRID, "zeroline": False, "linecolor": FAINT, "showline": True, "ticks": "outside",
        "tickcolor": FAINT, "automargin": True,
    }  # fmt: skip
    made.update_layout(
        template="none", height=height, font={"family": FONT, "size": 13, "color": INK},
        margin={"l": 56, "r": 16, "t": 12, "b": 48}, xaxis={**axis, "title": {"text": x}},
        yaxis={**axis, "title": {"text": y}}, paper_bgcolor="rgba(0,0,0,0)", plot_bgcolor="rgba(0,0,0,0)",
        legend={"orientation": "h", "y": -0.22, "yanchor": "top", "x": 0, "xanchor": "left"}, hovermode="closest",
        hoverlabel={"font": {"family": FONT}},
    )  # fmt: skip
    return made


def line(style: Style) -> dict[str, object]:
    """The line of a method."""
    return {"color": style.color, "dash": style.dash, "width": 2}


def logarithmic(made: go.Figure, axis: str) -> None:
    """Make an axis logarithmic with ticks at powers of ten, also where the data span less than one."""
    made.update_layout({axis: {"type": "log", "exponentformat": "power", "minor": {"ticks": "outside"}}})
