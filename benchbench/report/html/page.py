"""The page itself: charts, tables and plans put into the template."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pandas as pd
import plotly.graph_objects as go
import plotly.io
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from benchbench import __version__
from benchbench.analysis.races import races
from benchbench.report.html import room, tables
from benchbench.report.html.charts import cost_split, failures, flights, profiles, travel_time, work_precision
from benchbench.report.html.charts import success as successes
from benchbench.report.html.charts.chart import Chart, styles
from benchbench.report.html.race_table import race_rows
from benchbench.storage.status import Status

VERSIONS = (
    "benchbench_version", "git_commit", "git_dirty", "python_version", "casadi_version", "numpy_version",
    "solver_version",
)  # fmt: skip
MACHINE = ("platform", "cpu", "cpu_count", "threads")
CONFIG = {"displaylogo": False, "responsive": True, "modeBarButtons": [["toImage"]]}


@dataclass(frozen=True)
class PlanView:
    """A plan ready to be shown; `facts` are its numbers in words, `config` its YAML."""

    run_id: str
    title: str
    certified: bool
    reasons: Sequence[str]
    advice: str
    facts: Mapping[str, str]
    view: go.Figure
    limits: go.Figure
    config: str


@dataclass(frozen=True)
class Report:
    """Everything the page shows.

    runs      named runs, see benchbench.analysis.naming, with their `solve_s`, see benchbench.analysis.costs
    settings  flat configuration of each run, None where it is not known
    plans     those shown, best first
    missing   why other plans are not shown, one sentence each
    problems  files that could not be used
    rows      largest number of runs in the list
    """

    title: str
    runs: pd.DataFrame
    settings: Sequence[Mapping[str, Any] | None]
    plans: Sequence[PlanView]
    missing: Sequence[str]
    problems: Mapping[Path, str]
    rows: int = room.ROWS


def render(report: Report) -> str:
    """Return the page as one HTML document without any reference to the network."""
    runs = report.runs
    some, settings, left_out = room.compared(runs, report.settings)
    race_gates, raced = race_rows(races(some, settings))
    rows, unlisted = room.listed(runs, report.rows)
    means, means_note = tables.mean_rows(some, _time_limit(report.settings))
    return (
        environment()
        .get_template("report.html")
        .render(
            report=report,
            **stamp(),
            headline=_headline(runs),
            left_out=left_out,
            unlisted=unlisted,
            most_files=room.FILES,
            sections=_sections(some),
            success_rows=tables.success_rows(some),
            race_gates=race_gates,
            race_rows=raced,
            means=means,
            means_note=means_note,
            table=tables.run_table(rows),
            versions=tables.facts(runs, VERSIONS),
            machine=tables.facts(runs, MACHINE),
            differing=tables.differing(report.settings),
            statuses=[status for status in Status if (runs.status == status).any()],
            plotly=plotly_library(),
        )
    )


def environment() -> Environment:
    """Return what fills the templates beside this file."""
    found = Environment(
        loader=PackageLoader("benchbench.report.html", "templates"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    found.filters |= {"figure": _figure, "inline": _inline}
    return found


def stamp() -> dict[str, str]:
    """When a page was made, and by which version."""
    return {"made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"), "version": __version__}


def plotly_library() -> Markup:
    """The drawing library itself, to stand in a script element."""
    return Markup(get_plotlyjs())


def _sections(runs: pd.DataFrame) -> dict[str, list[Chart]]:
    style = styles(runs.method)
    return {
        "success": [successes.chart(runs), failures.chart(runs)],
        **({"flights": [flights.chart(runs)]} if flights.flown(runs) else {}),
        "speed": [
            profiles.performance(runs, style),
            profiles.data(runs, style),
            work_precision.chart(runs, style),
            cost_split.work(runs),
            cost_split.steps(runs),
        ],
        "travel time": [
            travel_time.chart(runs, style, "kappa_init"),
            travel_time.chart(runs, style, "intervals"),
        ],
    }


def _headline(runs: pd.DataFrame) -> dict[str, str]:
    claimed, certified = (successes.rate(runs[column]) for column in ("claimed_success", "certified"))
    return {
        "runs": str(len(runs)),
        "methods": str(runs.method.nunique()),
        "problems": str(runs.problem.nunique()),
        "claimed": tables.percent(claimed),
        "certified": tables.percent(certified),
    }


def _time_limit(settings: Sequence[Mapping[str, Any] | None]) -> float | None:
    """The largest time limit of the runs, s."""
    limits = [one["time_limit"] for one in settings if one is not None and "time_limit" in one]
    return max((float(limit) for limit in limits if isinstance(limit, int | float)), default=None)


def _figure(figure: go.Figure) -> Markup:
    """A figure as JSON that may stand in a script element."""
    text = plotly.io.to_json(figure, validate=False)
    values = f'{text[:-1]}, "config": {plotly.io.json.to_json_plotly(CONFIG)}}}'
    return Markup(values.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))


def _inline(name: str) -> Markup:
    """A file beside the templates, as it is."""
    return Markup((Path(__file__).parent / "templates" / name).read_text(encoding="utf-8"))
