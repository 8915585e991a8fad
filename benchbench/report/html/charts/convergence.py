"""How solvers get there: violation and objective of one problem, over iterations and over CPU time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from plotly.subplots import make_subplots

from benchbench.report.html.charts.chart import Chart, Styles, figure, line
from benchbench.storage.convergence import Iterate

LEAST = 1e-12
"""Smallest violation that is drawn."""
OVER = {"iterations": "iteration", "CPU time [s]": "cpu_s"}


@dataclass(frozen=True)
class Converged:
    """One run of each method on one problem that several were tried on."""

    problem: str
    runs: Mapping[str, Sequence[Iterate]]


def chart(converged: Converged, styles: Styles) -> Chart:
    """Draw a line for each method, and buttons for what it is drawn over; dots begin a solve."""
    title = f"Convergence on {converged.problem}"
    text = (
        "One run of each method: the worst violation and the objective of the problem that is solved at each iteration, as the solver "
        "tells them. A dot begins a solve: the next grid, step of the homotopy or guess. CPU time is that of each solve, spread evenly "
        "over its iterations."
    )
    made = make_subplots(2, 1, shared_xaxes=True, vertical_spacing=0.06, row_heights=[0.55, 0.45])
    base = figure(names=converged.runs, height=470).layout
    look = {name: value for name, value in base.xaxis.to_plotly_json().items() if name != "title"}
    made.update_layout(base).update_xaxes(**look).update_yaxes(**look)
    for method, iterates in converged.runs.items():
        first = [i for i, one in enumerate(iterates) if i == 0 or iterates[i - 1].solve != one.solve]
        for row, values in (
            (1, [max(one.violation, LEAST) for one in iterates]), (2, [one.objective for one in iterates])
        ):  # fmt: skip
            made.add_scatter(
                x=[one.iteration for one in iterates], y=values, name=method, legendgroup=method, showlegend=row == 1,
                mode="lines+markers", line={**line(styles[method]), "width": 1.5},
                marker={"color": styles[method].color, "size": [7 if i in first else 0 for i in range(len(iterates))]},
                text=[one.stage for one in iterates], hovertemplate="%{text}<br>%{x:.4g}: %{y:.4g}", row=row, col=1,
            )  # fmt: skip
    made.update_xaxes(title_text="iterations", row=2, col=1)
    made.update_yaxes(title_text="violation", type="log", exponentformat="power", dtick=2, row=1, col=1)
    made.update_yaxes(title_text="objective", row=2, col=1)
    made.update_layout(updatemenus=[_buttons(converged)], showlegend=True, margin_t=46)
    return Chart(title, text, made)


def _buttons(converged: Converged) -> dict[str, object]:
    buttons = []
    for label, name in OVER.items():
        x = [[getattr(one, name) for one in iterates] for iterates in converged.runs.values() for _ in (1, 2)]
        change = {"xaxis2.title.text": label, "xaxis.autorange": True, "xaxis2.autorange": True}
        buttons.append({"label": label, "method": "update", "args": [{"x": x}, change]})
    return {
        "type": "buttons", "direction": "right", "buttons": buttons, "x": 0.0, "xanchor": "left", "y": 1.02, "yanchor": "bottom",
        "active": 0, "pad": {"b": 4},
    }  # fmt: skip
