"""The best travel time known of each task, as the truth that travel times are measured against."""

from __future__ import annotations

import pandas as pd


def travel_time_errors(runs: pd.DataFrame) -> pd.Series:
    """Relative distance of each certified travel time from the best one of its task, on whatever grid; NaN without one.

    runs: with the columns `task`, `kappa_init`, `certified`, `travel_time_s`, `intervals`. The truth of a task is the fastest certified plan on
    the finest grid on which there is one: on coarse grids a plan may be faster than the truth by what its transcription is wrong
    by, within the limits of the certificate.
    """
    certified = runs.certified.fillna(False).astype(bool)
    times = runs.travel_time_s.astype(float).where(certified)
    grids = runs.intervals.astype(float).where(certified)
    key = [runs.task, runs.kappa_init.map(str)]
    finest = grids.groupby(key).transform("max")
    truth = times.where(grids == finest).groupby(key).transform("min")
    return (times / truth - 1).abs()
