"""The picture of a plan: one page with the motion in space and everything that is limited over time."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatch
from math import ceil
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from benchbench.certificate.replay import Replay
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.report.contact_window import contact_windows
from benchbench.report.grid import LABEL_IN, TITLE_IN, Margins
from benchbench.report.limits_panel import limit_panels
from benchbench.report.panel import Panel, draw_panel
from benchbench.report.panels import conditions
from benchbench.report.png import Picture, write_png
from benchbench.report.race import race_figure
from benchbench.report.scene import Scene, scene
from benchbench.report.style import CONTACT, INK, LIMIT, RC, verdict_colour
from benchbench.report.views import draw_view, label_times, legend_handles
from benchbench.storage.files import replacing

WIDTH_IN = 14.0
HEADER_IN, ROW_IN = 1.15, 1.75
VIEW_SHARE = 0.6
"""Width of the views without their labels, as a share of the page."""
WIDE_SHARE = 0.93
"""The same where the views have the whole width."""
FLAT = 0.8
"""Height of the views, as a share of that of the contacts beside them, below which they get the whole width: the motion is flat."""
COLUMNS = 4
VIEW_LABELS_IN = 0.75
"""Height of title, numbers and label of a view."""
PANELS = Margins(between_rows=TITLE_IN + 0.1)
TIMES_IN = 0.2
"""Height of the times above the side view."""
VIEWS = Margins(left=0.64, right=0.2, between_rows=LABEL_IN + TITLE_IN + 0.08)


@dataclass(frozen=True)
class Page:
    """Everything on the page, worked out before anything is drawn."""

    scene: Scene
    contacts: list[Panel]
    limits: list[Panel]
    windows: list[tuple[float, float]]
    title: str
    subtitle: str
    verdict: str


def draw(
    path: Path,
    plan: Plan,
    scenario: Scenario,
    model: Model,
    replay: Replay | None,
    title: str,
    verdict: str,
) -> None:
    """Write the picture of a plan, `figure`, as PNG, 2100 px wide.

    Raises BadInput("output", ...) when the file system refuses.
    """
    with mpl.rc_context(RC), replacing(path) as temporary:
        write_png(drawn(scenario, plan, model, replay, title, verdict), temporary)


def figure(
    plan: Plan, scenario: Scenario, model: Model, replay: Replay | None, title: str, verdict: str
) -> Figure:
    """Return the picture of a plan as a figure that a notebook shows; no state of pyplot plays a part.

    replay   the inputs on the plant, on a dense grid; None draws the plan alone
    title    what was run, for example scenario and solver
    verdict  "certified", more may follow, or "NOT certified: <first reason>"
    """
    with mpl.rc_context(RC):
        return drawn(scenario, plan, model, replay, title, verdict)


@singledispatch
def drawn(
    scenario: Scenario, plan: Plan, model: Model, replay: Replay | None, title: str, verdict: str
) -> Figure:
    """Draw the page: views of the motion, contacts and limits over time, unless the kind of scenario has a page of its own."""
    return compose(page(plan, scenario, model, replay, title, verdict), replay is not None)


drawn.register(Race, race_figure)


def page(
    plan: Plan, scenario: Scenario, model: Model, replay: Replay | None, title: str, verdict: str
) -> Page:
    """Work out what the page shows."""
    times = [(float(plan.time[a]), float(plan.time[b])) for a, b in contact_windows(plan)]
    return Page(
        scene(plan, scenario, model, replay),
        conditions(scenario, plan, model, replay),
        limit_panels(plan, scenario, model, replay),
        times,
        title,
        _subtitle(plan, scenario, times),
        verdict,
    )


def _subtitle(plan: Plan, scenario: Scenario, windows: Sequence[tuple[float, float]]) -> str:
    contact = ", ".join(f"{start:.3f} to {end:.3f} s" for start, end in windows[:3]) or "none claimed"
    more = f" and {len(windows) - 3} more" if len(windows) > 3 else ""
    touched = f"   |   contact {contact}{more}" if scenario.itinerary.stops else ""
    return f"travel time {plan.travel_time:.3f} s{touched}"


def compose(page: Page, replayed: bool) -> Figure:
    """Lay the page out; `replayed` says what the lines between the nodes are."""
    beside = ROW_IN * len(page.contacts)
    wide = sum(_view_heights(page.scene, VIEW_SHARE)) < FLAT * beside
    views = _view_heights(page.scene, WIDE_SHARE if wide else VIEW_SHARE)
    panels = [*page.contacts, *page.limits] if wide else page.limits
    rows = ceil(len(panels) / COLUMNS)
    heights = [HEADER_IN, sum(views) if wide else max(sum(views), beside), ROW_IN * rows]
    figure = Picture(figsize=(WIDTH_IN, sum(heights)), facecolor="white")
    header, top, bottom = figure.subfigures(3, 1, height_ratios=heights, squeeze=False, hspace=0)[:, 0]
    _header(header, page, replayed)
    if wide:
        _views(top, page.scene, views)
    else:
        left, right = top.subfigures(1, 2, width_ratios=[2, 1], squeeze=False, wspace=0)[0]
        _views(left, page.scene, views)
        _grid(right, page.contacts, page, len(page.contacts), 1)
    _grid(bottom, panels, page, rows, COLUMNS)
    return figure


def _header(figure: SubFigure, page: Page, replayed: bool) -> None:
    verdict = "\n".join(textwrap.wrap(page.verdict, 60, max_lines=2, placeholder=" ..."))
    title = textwrap.shorten(page.title, 72, placeholder=" ...")
    figure.text(0.008, 0.90, title, fontsize=14, fontweight="bold", va="top")
    figure.text(0.008, 0.54, page.subtitle, fontsize=11, va="top", color=INK)
    figure.text(
        0.988,
        0.88,
        verdict,
        fontsize=12,
        fontweight="bold",
        va="top",
        ha="right",
        color="white",
        bbox={"boxstyle": "round,pad=0.45", "facecolor": verdict_colour(page.verdict), "edgecolor": "none"},
    )
    between = "replay of the inputs" if replayed else "plan"
    keys = [
        *legend_handles(bool(page.scene.targets), bool(page.scene.obstacles.outlines)),
        Line2D([], [], color=INK, marker=".", linestyle="", label="planned nodes"),
        Line2D([], [], color=INK, linewidth=1.1, label=between),
        Line2D([], [], color=LIMIT, linewidth=1.1, linestyle=(0, (4, 3)), label="limit"),
        *([Patch(facecolor=CONTACT, alpha=0.4, label="contact")] if page.scene.targets else []),
    ]
    figure.legend(
        handles=keys, loc="lower left", ncols=len(keys), frameon=False, fontsize=9, columnspacing=1.8
    )


def _views(figure: SubFigure, scene: Scene, heights: Sequence[float]) -> None:
    shares = [height - VIEW_LABELS_IN for height in heights]
    shares[0] += TIMES_IN
    place = VIEWS.grid(figure, len(heights), 1)
    axes = figure.subplots(
        len(heights), 1, squeeze=False, sharex=True, height_ratios=shares, gridspec_kw=place
    )[:, 0]
    for cell, plane in zip(axes, scene.planes, strict=True):
        draw_view(cell, scene, plane)
    label_times(axes[0], scene, scene.planes[0])


def _view_heights(scene: Scene, share: float) -> list[float]:
    """Heights (in) that give each view the scale of the width, of which its plot takes a share."""
    x, y, z = scene.extent
    scale = WIDTH_IN * share / max(x, 1.2 * y, 1.2 * z)
    return [scale * scene.extent[upward] + VIEW_LABELS_IN for _, upward in scene.planes]


def _grid(figure: SubFigure, panels: list[Panel], page: Page, rows: int, columns: int) -> None:
    """Fill a grid of panels row by row; the last one of each column carries the numbers and the label of the time axis."""
    if not panels:
        return
    place = PANELS.grid(figure, rows, columns)
    cells = figure.subplots(rows, columns, squeeze=False, gridspec_kw=place).ravel()
    for i, axes in enumerate(cells):
        if i >= len(panels):
            axes.set_axis_off()
            continue
        draw_panel(axes, panels[i], page.windows, page.scene.plan.travel_time)
        last = i + columns >= len(panels)
        axes.tick_params(axis="x", labelbottom=last)
        axes.set_xlabel("time [s]" if last else "")
