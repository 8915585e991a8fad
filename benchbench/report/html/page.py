"""The page itself: charts, tables and plans put into the template."""

from __future__ import annotations

import base64
import gzip
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pandas as pd
import plotly.graph_objects as go
import plotly.io
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape
from plotly.offline import get_plotlyjs

from benchbench import __version__
from benchbench.analysis.races import races
from benchbench.report.claims import Claim, load, said
from benchbench.report.html import room, tables
from benchbench.report.html.charts import (
    convergence,
    cost_split,
    drift,
    failures,
    flights,
    profiles,
    slack,
    travel_time,
    work_precision,
)
from benchbench.report.html.charts import success as successes
from benchbench.report.html.charts.chart import Chart, styles
from benchbench.report.html.objective_table import objective_rows
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
    converged how methods converged on one problem, None where nothing is known of it
    claims    what the paper claims, and what came of it
    """

    title: str
    runs: pd.DataFrame
    settings: Sequence[Mapping[str, Any] | None]
    plans: Sequence[PlanView]
    missing: Sequence[str]
    problems: Mapping[Path, str]
    rows: int = room.ROWS
    converged: convergence.Converged | None = None
    claims: Sequence[Claim] = field(default_factory=load)


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
            sections=(sections := _sections(report, some, settings)),
            menu=[name for name, charts in sections.items() if any(chart.figure for chart in charts)],
            said=said,
            success_rows=tables.success_rows(some),
            race_gates=race_gates,
            race_rows=raced,
            objective_rows=objective_rows(some),
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
    found.filters |= {
        "figure": _figure,
        "inline": _inline,
        "marked": _marked,
        "packed_figure": _packed_figure,
    }
    return found


def stamp() -> dict[str, str]:
    """When a page was made, and by which version."""
    return {"made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"), "version": __version__}


def plotly_library() -> Markup:
    """The drawing library itself, packed, to stand in a script element."""
    return packed(get_plotlyjs())


def _sections(
    report: Report, runs: pd.DataFrame, settings: Sequence[Mapping[str, Any] | None]
) -> dict[str, list[Chart]]:
    style = styles([*runs.method, *(report.converged.runs if report.converged else ())])
    slacks = list(slack.charts(runs, settings))
    return {
        "success": [successes.chart(runs), failures.chart(runs)],
        **({"flights": [flights.chart(runs)]} if flights.flown(runs) else {}),
        "speed": [
            profiles.performance(runs, style),
            profiles.data(runs, style),
            work_precision.chart(runs, style),
            work_precision.travel_time(runs, style),
            *([convergence.chart(report.converged, style)] if report.converged else []),
            cost_split.work(runs),
            cost_split.steps(runs),
            *drift.charts(runs),
        ],
        "travel time": [
            travel_time.chart(runs, style, "kappa_init"),
            travel_time.chart(runs, style, "intervals"),
        ],
        **({"slack": slacks} if slacks else {}),
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


def packed(text: str) -> Markup:
    """A text gzipped, in base64: a browser unpacks it at once, and the page takes a third of the space."""
    return Markup(base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode())


def _packed_figure(figure: go.Figure) -> Markup:
    return packed(str(_figure(figure)))


def _figure(figure: go.Figure) -> Markup:
    """A figure as JSON that may stand in a script element."""
    text = plotly.io.to_json(figure, validate=False)
    values = f'{text[:-1]}, "config": {plotly.io.json.to_json_plotly(CONFIG)}}}'
    return Markup(values.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))


def _marked(text: str) -> Markup:
    """Markdown of one line: code in backticks, and of links their texts."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(plain))))


def _inline(name: str) -> Markup:
    """A file beside the templates, as it is."""
    return Markup((Path(__file__).parent / "templates" / name).read_text(encoding="utf-8"))
