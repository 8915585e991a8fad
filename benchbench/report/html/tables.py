"""Tables of the report as plain texts, ready for the template."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from benchbench.analysis.costs import comparable, cost_matrix
from benchbench.analysis.means import three_means
from benchbench.analysis.wilson import Rate
from benchbench.report.html.charts.profiles import left_out
from benchbench.report.html.charts.success import Success, success
from benchbench.storage.schema import COLUMNS

SHIFT_S = 1.0
"""Shift of the geometric means: a difference far below a second decides nothing."""

RUN_COLUMNS = (
    "run_id", "scenario", "intervals", "kappa_init", "dynamics", "relaxation", "solver", "strategy", "guess", "status",
    "claimed_success", "travel_time_s", "gap_percent", "best_known_s", "best_known_objective", "published_objective", "iterations",
    "solve_cpu_s", "replay_defect_position_m",
    "contact_gaps", "reasons", "advice", "objective", "lower_bound_s",
    "evaluations", "build_cpu_s", "certificate_cpu_s", "wall_s", "peak_memory_mb", "max_violation",
    "max_complementarity", "replay_drift_position_m", "replay_end_error_m", "max_rate_ratio", "contact_steps",
    "contact_duration_s", "gates", "gates_passed", "gate_worst_miss_m", "flights", "flights_succeeded", "flights_low_exact",
    "flight_reasons", "flight_error_before_m", "flight_error_after_m", "flight_touch_p95_mps", "residual", "mismatch", "vehicle", "seed",
)  # fmt: skip
_BY_NAME = {column.name: column for column in COLUMNS}


@dataclass(frozen=True)
class Cell:
    """What is shown, what it is sorted by ("" where there is nothing), what a pointer shows."""

    text: str
    key: str
    hint: str = ""


@dataclass(frozen=True)
class Head:
    """Head of a column: name, unit, meaning, whether it holds numbers."""

    name: str
    unit: str
    meaning: str
    numeric: bool


@dataclass(frozen=True)
class RunTable:
    """All runs; `rows` are as long as `heads`."""

    heads: Sequence[Head]
    rows: Sequence[Sequence[Cell]]


def run_table(runs: pd.DataFrame) -> RunTable:
    """Return the columns that say something about these runs."""
    shown = [one for name in RUN_COLUMNS for one in _shown(runs, name)]
    rows = zip(*(values for _, values in shown), strict=True)
    return RunTable([head for head, _ in shown], [[cell(value) for value in row] for row in rows])


def _shown(runs: pd.DataFrame, name: str) -> Iterator[tuple[Head, list[Any]]]:
    """A column with its values, where it says something; numbers by name are a column each."""
    column, values = _BY_NAME[name], list(runs[name])
    if column.type == "numbers":
        given = [value if isinstance(value, Mapping) else {} for value in values]
        for key in dict.fromkeys(key for one in given for key in one):
            yield Head(f"{name} {key}", "", column.meaning, True), [one.get(key) for one in given]
    elif name == "run_id" or _any(runs[name]):
        yield Head(name, column.unit, column.meaning, column.type in ("int", "float")), values


def cell(value: Any) -> Cell:
    """Show a value of the record."""
    if isinstance(value, (list, tuple, np.ndarray)):
        texts = [str(text) for text in value]
        more = f" (+{len(texts) - 1})" if len(texts) > 1 else ""
        return Cell((texts[0] if texts else "") + more, "; ".join(texts), "\n".join(texts))
    if value is None or pd.isna(value):
        return Cell("", "")
    if isinstance(value, (bool, np.bool_)):
        return Cell("yes" if value else "no", "yes" if value else "no")
    if isinstance(value, (float, np.floating)):
        return Cell(f"{value:.4g}", repr(float(value)), repr(float(value)))
    return Cell(str(value), str(value))


def success_rows(runs: pd.DataFrame) -> list[list[str]]:
    """Method, runs, claimed, certified; rates with their intervals."""
    return [_success_row(one) for one in success(runs)]


def percent(rate: Rate) -> str:
    """A rate in words, for example "80 % (49 to 94 %)"."""
    if rate.rate is None:
        return "none"
    return f"{100 * rate.rate:.0f} % ({100 * rate.low:.0f} to {100 * rate.high:.0f} %)"


def mean_rows(runs: pd.DataFrame, time_limit: float | None) -> tuple[list[list[str]], str]:
    """Shifted geometric means of the solver's CPU time per method, and how they were counted.

    time_limit: s, the price of a failure; None takes the slowest certified run.
    """
    table = cost_matrix(runs, "solve_s")
    costs = comparable(table)
    values = costs.to_numpy(float)
    finite = values[np.isfinite(values)]
    if not finite.size:
        return [], "No problem that every method was tried on was solved."
    slowest = float(finite.max())
    penalty = max(time_limit or 0.0, slowest)
    source = "the time limit" if penalty == time_limit else "the slowest certified run"
    common = int(np.isfinite(values).all(axis=1).sum())
    note = (
        f"Shift {SHIFT_S:g} s, {len(costs)} problems tried by every method, {common} solved by every method; "
        f"a failure costs {penalty:.3g} s ({source}).{left_out(table, costs)}"
    )
    means = three_means(costs, SHIFT_S, penalty)
    return [[method, _s(m.own), _s(m.common), _s(m.penalised)] for method, m in means.items()], note


def facts(runs: pd.DataFrame, columns: Iterable[str]) -> list[tuple[str, str, str]]:
    """Name, meaning and values of provenance columns; several values with how many runs have them."""
    return [(name, _BY_NAME[name].meaning, _values(runs[name])) for name in columns if _any(runs[name])]


def differing(settings: Sequence[Mapping[str, Any] | None]) -> list[tuple[str, str]]:
    """Fields of the configuration that are not the same in all runs, with their values."""
    known = [one for one in settings if one is not None]
    fields = sorted({name for one in known for name in one})
    values = {name: list(dict.fromkeys(str(one[name]) for one in known if name in one)) for name in fields}
    return [
        (name, ", ".join(v[:12]) + (f" and {len(v) - 12} more" if len(v) > 12 else ""))
        for name, v in values.items()
        if len(v) > 1
    ]


def _success_row(one: Success) -> list[str]:
    return [one.method, str(one.certified.runs), percent(one.claimed), percent(one.certified)]


def _values(column: pd.Series) -> str:
    counts = column.dropna().astype(str).value_counts()
    if len(counts) == 1:
        return str(counts.index[0])
    return ", ".join(f"{value} ({count} runs)" for value, count in counts.items())


def _any(column: pd.Series) -> bool:
    return any(cell(value).text for value in column)


def _s(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
