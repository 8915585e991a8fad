"""Runs that differ in one number of the task alone: what it costs in travel time."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

SLACK = re.compile(
    r"scenario\.contacts\.\w+\.(?!weight)\w+|certificate\.[\w.]+|scenario\.(?:contact_seconds|radius|end_radius)"
)
"""Fields by which a task is made looser: limits of contacts (nu_max, c_limit of the paper), radii of gates, tolerances of the certificate."""
NO_SLACK = ("certificate._target_", "certificate.stationarity", "certificate.stationarity_seconds")


def slacks(settings: Sequence[Mapping[str, Any] | None]) -> list[str]:
    """Return the numeric fields of slack in which runs differ, by name."""
    known = [one for one in settings if one is not None]
    names = {name for one in known for name in one}  # of ten thousands of runs, a few hundred
    slack = sorted(name for name in names if SLACK.fullmatch(name) and name not in NO_SLACK)
    values = {name: {float(one[name]) for one in known if _is_number(one.get(name))} for name in slack}
    return [name for name, found in values.items() if len(found) > 1]


def varied(runs: pd.DataFrame, settings: Sequence[Mapping[str, Any] | None], field: str) -> pd.DataFrame:
    """Return the certified runs that have the field, with its `value` and `line`: what is the same for all else.

    runs: with `method` and `travel_time_s`. Lines of one value alone are left out; of several runs at one value the fastest stays.
    """
    certified = runs.certified.fillna(False).astype(bool)
    rows = []
    for i, (one, good) in enumerate(zip(settings, certified, strict=True)):
        if one is not None and good and _is_number(one.get(field)):
            rest = _rest(one, field)
            rows.append(
                (
                    float(one[field]),
                    str(rest),
                    str(runs.scenario.iloc[i]),
                    runs.method.iloc[i],
                    runs.travel_time_s.iloc[i],
                )
            )
    found = pd.DataFrame(rows, columns=["value", "rest", "scenario", "method", "travel_time_s"])
    best = found.sort_values("travel_time_s", kind="stable").drop_duplicates(["rest", "scenario", "value"])
    return best[best.groupby("rest").value.transform("nunique") > 1].sort_values(["rest", "value"])


def _rest(one: Mapping[str, Any], field: str) -> tuple[tuple[str, str], ...]:
    """All else that decides a travel time."""
    families = ("scenario.", "vehicle.", "dynamics.", "certificate.", "strategy.", "relaxation.", "solver.")
    return tuple(
        sorted(
            (k, str(v))
            for k, v in one.items()
            if k != field and (k.startswith(families) or k in ("accuracy", "seed"))
        )
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
