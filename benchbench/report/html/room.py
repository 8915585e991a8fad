"""What a page has room for: a large folder of results is summarised, and the page says what it leaves out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

METHODS, POINTS, ROWS, FILES = 40, 2000, 1000, 200
"""Most methods in charts and tables, points in a chart, runs in the list, files that are named."""

Settings = Sequence[Mapping[str, Any] | None]


def compared(runs: pd.DataFrame, settings: Settings) -> tuple[pd.DataFrame, Settings, str]:
    """Return the runs of at most `METHODS` methods with their settings, and what has to be said of it, "" for nothing.

    Those with the most certified runs stay, then those with the most runs, in the order in which they come.
    """
    count = runs.method.nunique()
    if count <= METHODS:
        return runs, settings, ""
    each = runs.assign(good=runs.certified.fillna(False).astype(bool)).groupby("method", sort=False).good
    best = each.agg(["sum", "size"]).sort_values(["sum", "size"], ascending=False, kind="stable").index
    kept: list[int] = np.flatnonzero(runs.method.isin(best[:METHODS])).tolist()
    said = f"{METHODS} of {count} methods are compared, those with the most certified runs: {len(kept)} of {len(runs)} runs."
    return runs.iloc[kept].reset_index(drop=True), [settings[i] for i in kept], said


def drawn(runs: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """Return at most `POINTS` of the runs, drawn at random but always the same, and what has to be said of it."""
    if len(runs) <= POINTS:
        return runs, ""
    said = f" {POINTS} of {len(runs)} runs are drawn, taken at random."
    return runs.sample(POINTS, random_state=0).sort_index(), said


def listed(runs: pd.DataFrame, most: int) -> tuple[pd.DataFrame, str]:
    """Return at most so many runs, the first ones of every method and outcome, and what has to be said of it."""
    if len(runs) <= most:
        return runs, ""
    turn = runs.groupby(["method", "status"], dropna=False, sort=False).cumcount().to_numpy()
    kept = np.sort(np.argsort(turn, kind="stable")[:most])
    said = (
        f"{most} of {len(runs)} runs are listed, the first ones of every method and outcome; "
        "benchbench report --rows N lists more, benchbench table writes all."
    )
    return runs.iloc[kept], said
