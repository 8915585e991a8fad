"""The table of MPCCs that are no flight as plain texts: what each method found of each, beside what is known and published."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd


@dataclass(frozen=True)
class ObjectiveRow:
    """A problem and a method: texts of its cells, where the optimum is published, how many of its runs are certified."""

    problem: str
    method: str
    objective: str
    gap: str
    best_known: str
    published: str
    source: str
    cpu: str
    verdict: str
    good: bool


def objective_rows(runs: pd.DataFrame) -> list[ObjectiveRow]:
    """Return the table, by problem and method; empty where all runs are flights.

    runs: named, with their `solve_s`; of several runs of one kind the least certified objective, and the median of the CPU time.
    """
    ready = runs[runs.vehicle.isna() & runs.intervals.isna() & runs.mpcc_hash.notna()]
    groups = ready.groupby(["problem", "method"], sort=True)
    return [_row(str(problem), str(method), same) for (problem, method), same in groups]


def _row(problem: str, method: str, same: pd.DataFrame) -> ObjectiveRow:
    good = same[same.certified.fillna(False).astype(bool)]
    sources = same.published_source.dropna()
    return ObjectiveRow(
        problem, method, _said(good.objective, "{:.8g}"), _said(good.gap_percent, "{:+.3f} %"),
        _said(same.best_known_objective, "{:.8g}"), _said(same.published_objective, "{:.8g}"),
        str(sources.iloc[0]) if len(sources) else "", f"{same.solve_s.astype(float).median():.3g} s",
        "certified" if len(good) == len(same) == 1 else f"{len(good)} of {len(same)} certified", len(good) > 0,
    )  # fmt: skip


def _said(values: pd.Series, form: str) -> str:
    """The least of them that is known."""
    least = values.astype(float).min()
    return "" if pd.isna(least) else form.format(least)
