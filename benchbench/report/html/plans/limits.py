"""Everything that is limited, over time, with a cursor that follows the slider."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from math import ceil
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from benchbench.report.html.charts.chart import CLEAR, FONT, GRID
from benchbench.report.panel import Band, Curve, Panel, Points, dashes, span
from benchbench.report.style import CONTACT, CURVES, FAINT, INK, LIMIT

COLUMNS, ROW_PX, PERIOD_PX = 2, 128, 16.0
TITLE_LETTERS = 34
"""Longest title that fits on a narrow page in the usual size."""


def limits(
    panels: Sequence[Panel],
    windows: Sequence[tuple[float, float]],
    travel_time: float,
    window: str = "in contact",
) -> go.Figure:
    """Return small plots of the panels; the shapes named `cursor` follow the time; `window` is what the windows are."""
    rows = max(ceil(len(panels) / COLUMNS), 1)
    titles = [_title(panel) for panel in panels]
    made = make_subplots(
        rows, COLUMNS, subplot_titles=titles, vertical_spacing=0.36 / rows, horizontal_spacing=0.1
    )
    for i, panel in enumerate(panels):
        row, column = divmod(i, COLUMNS)
        _draw(made, panel, row + 1, column + 1)
    made.add_traces(_key(window if windows else "", panels))
    axis = {"gridcolor": GRID, "zeroline": False, "tickcolor": FAINT, "tickfont": {"size": 10}, "nticks": 5}
    made.update_xaxes(range=[0.0, travel_time], **axis)
    for i in range(max(len(panels) - COLUMNS, 0), len(panels)):
        made.layout[f"xaxis{_number(i)}"].title = {"text": "time [s]", "font": {"size": 11}, "standoff": 2}
    made.update_yaxes(**axis, exponentformat="power")
    for annotation, panel in zip(made.layout.annotations, panels, strict=True):
        annotation.font = {"size": 12 if len(_words(panel)) <= TITLE_LETTERS else 10, "color": INK}
    made.update_layout(
        template="none", height=ROW_PX * rows + 84, font={"family": FONT, "color": INK, "size": 11}, showlegend=True,
        legend={"orientation": "h", "yref": "container", "y": 0.0, "yanchor": "bottom", "x": 0.0, "itemclick": False, "itemdoubleclick": False},
        margin={"l": 44, "r": 10, "t": 42, "b": 70}, paper_bgcolor=CLEAR, plot_bgcolor=CLEAR,
        modebar={"bgcolor": CLEAR, "color": FAINT, "activecolor": INK},
        hovermode="closest", shapes=[*_cursors(len(panels)), *_windows(len(panels), windows), *_bounds(panels)],
    )  # fmt: skip
    return made


def _title(panel: Panel) -> str:
    """Quantity and unit, and the names of several curves in their colours."""
    title = f"{panel.title} [{panel.unit}]"
    pairs = zip(_labels(panel), _colors(panel), strict=False)
    names = [f'<span style="color:{color}">{escape(label)}</span>' for label, color in pairs]
    return f"{title}: {' '.join(names)}" if names else title


def _words(panel: Panel) -> str:
    """The title without its colours."""
    return " ".join([f"{panel.title} [{panel.unit}]:", *_labels(panel)])


def _labels(panel: Panel) -> list[str]:
    """Short names of several curves; one curve needs none."""
    labels = [curve.label.replace("_", " ") for curve in panel.curves]
    if len(labels) == 1:
        return []
    words, _, last = zip(*(label.rpartition(" ") for label in labels), strict=True)
    if len(set(words)) == 1:  # motor 1, motor 2, ...
        return [labels[0], *last[1:]]
    return labels


def _draw(made: go.Figure, panel: Panel, row: int, column: int) -> None:
    low, high = span(panel)
    for curve, color, dash in zip(panel.curves, _colors(panel), dashes(panel, PERIOD_PX), strict=True):
        for trace in _traces(curve, color, dash, panel.unit, low if panel.logarithmic else -np.inf):
            made.add_trace(trace, row, column)
    if panel.logarithmic:
        made.update_yaxes(type="log", dtick=1, range=np.log10([low, high]).tolist(), row=row, col=column)
    else:
        made.update_yaxes(range=[low, high], row=row, col=column)


def _traces(
    curve: Curve, color: str, dash: tuple[float, float] | None, unit: str, floor: float
) -> list[go.Scatter]:
    """Line and dots of a curve; what is below `floor` stays at the lower edge, as zeros on a logarithmic axis."""
    name = curve.label.replace("_", " ")
    hover = f"%{{y:.4g}} {unit} at %{{x:.3f}} s<extra>{name}</extra>"
    x, y = _points(curve.line, floor)
    traces = _band(curve.band)
    look: dict[str, Any] = {"hovertemplate": hover, "showlegend": False}
    line = {"color": color, "width": 1.4, "dash": f"{dash[0]}px,{dash[1]}px" if dash else "solid"}
    traces += [go.Scatter(x=x, y=y, mode="lines", line=line, **look)]
    if curve.dots is not None:
        x, y = _points(curve.dots, floor)
        traces.append(go.Scatter(x=x, y=y, mode="markers", marker={"color": color, "size": 3}, **look))
    return traces


def _band(band: Band | None) -> list[go.Scatter]:
    """Limits that change, as dashed lines."""
    if band is None:
        return []
    look: dict[str, Any] = {
        "mode": "lines",
        "line": {"color": LIMIT, "width": 1.2, "dash": "dash"},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    return [go.Scatter(x=band.time, y=limit, **look) for limit in (band.lower, band.upper)]


def _key(window: str, panels: Sequence[Panel]) -> list[go.Scatter]:
    """Entries of the legend, which draw nothing: how plan, replay, limits and contact look."""
    dotted = any(curve.dots is not None for panel in panels for curve in panel.curves)
    square = {"color": CONTACT, "symbol": "square", "size": 11, "opacity": 0.5}
    looks: list[tuple[str, dict[str, Any]]] = [
        *([("planned", {"mode": "markers", "marker": {"color": INK, "size": 4}})] if dotted else []),
        ("flown", {"mode": "lines", "line": {"color": INK, "width": 1.4}}),
        ("limit", {"mode": "lines", "line": {"color": LIMIT, "width": 1.2, "dash": "dash"}}),
        *([(window, {"mode": "markers", "marker": square})] if window else []),
    ]
    return [go.Scatter(x=[None], y=[None], name=name, hoverinfo="skip", **look) for name, look in looks]


def _points(points: Points, floor: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    return points[0].astype(np.float32), np.maximum(points[1], floor).astype(np.float32)


def _colors(panel: Panel) -> list[str]:
    return [CURVES[i % len(CURVES)] for i in range(len(panel.curves))]


def _limit_colors(panel: Panel) -> list[str]:
    """Grey where all curves share their limits."""
    shared = len({(curve.lower, curve.upper) for curve in panel.curves}) == 1
    return [LIMIT] * len(panel.curves) if shared else _colors(panel)


def _cursors(count: int) -> list[dict[str, Any]]:
    return [
        {
            "type": "line",
            "name": "cursor",
            **_place(i),
            "x0": 0.0,
            "x1": 0.0,
            "line": {"color": INK, "width": 1},
        }
        for i in range(count)
    ]


def _windows(count: int, windows: Sequence[tuple[float, float]]) -> list[dict[str, Any]]:
    look = {"fillcolor": CONTACT, "opacity": 0.3, "line": {"color": CONTACT, "width": 1.5}, "layer": "below"}
    return [{"type": "rect", **_place(i), "x0": a, "x1": b, **look} for i in range(count) for a, b in windows]


def _bounds(panels: Sequence[Panel]) -> Iterator[dict[str, Any]]:
    """A dashed line per limit; curves with the same limits share it."""
    for i, panel in enumerate(panels):
        pairs = zip(panel.curves, _limit_colors(panel), strict=True)
        lines = {
            (v, color): None
            for c, color in pairs
            if c.band is None
            for v in (c.lower, c.upper)
            if np.isfinite(v)
        }
        for value, color in lines:
            across = {"xref": f"x{_number(i)} domain", "x0": 0.0, "x1": 1.0, "yref": f"y{_number(i)}"}
            look = {"color": color, "width": 1.2, "dash": "dash"}
            yield {"type": "line", **across, "y0": value, "y1": value, "line": look}


def _place(index: int) -> dict[str, Any]:
    return {"xref": f"x{_number(index)}", "yref": f"y{_number(index)} domain", "y0": 0.0, "y1": 1.0}


def _number(index: int) -> str:
    """Plotly's axes are x, x2, x3, ..."""
    return "" if index == 0 else str(index + 1)
