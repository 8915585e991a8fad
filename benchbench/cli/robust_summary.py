"""The end of a search for the fastest plan that succeeds: the front, as text, table and picture."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from benchbench.analysis.front import Candidate, candidate, fastest, front
from benchbench.cli.suite_summary import rows_of
from benchbench.run.overrides import keys
from benchbench.run.settings import NOT_DECISIVE
from benchbench.storage.files import write_bytes
from benchbench.sweep.sweep import Swept

FOLDER = "robust"
"""In the folder of results."""
COLUMNS = ("certified", "travel_time_s", "flights", "flights_succeeded", "flights_low_exact", "flights_low", "flights_high", "config_hash")  # fmt: skip
TARGET = 0.95
"""Where a run says none."""


def conclude(typed: Sequence[str], swept: Sequence[Swept]) -> None:
    """Print the front of what was flown, and write it; raises BadInput where it cannot be written."""
    rows = rows_of(swept, COLUMNS)
    found = [
        one
        for s in swept
        if s.place
        and (row := rows.get(s.place.labels["config_hash"]))
        and (one := candidate(_told(s.overrides), row))
    ]
    root = next((one.place.root for one in swept if one.place), None)
    if root is None or not found:
        print("no certified plan was flown")
        return
    target = next(
        (_number(text) for one in swept for text in one.overrides if "target_success" in keys([text])), TARGET
    )
    best, chosen = front(found), fastest(found, target)
    for one in sorted(found, key=lambda c: c.travel_time):
        mark = "->" if one is chosen else " *" if one in best else "  "
        flown = f"{one.succeeded} of {one.flights}"
        print(
            f"{mark} {one.travel_time:7.4f} s  {flown:>9} flights, {100 * one.low:5.1f} % proved  {_differing(one, found)}"
        )
    print(
        "->: the fastest that proves what is asked; *: the front, which no other plan beats in travel time and success"
    )
    path = root / FOLDER / f"{datetime.now():%Y-%m-%d_%H-%M-%S-%f}.csv"
    write_bytes(path, _table(found, best, chosen).encode())
    _draw(path.with_suffix(".png"), found, target, typed)
    print(f"front        {path}\n             {path.with_suffix('.png')}")
    if chosen is None:
        print(
            f"no plan proves {100 * target:g} %: more flights (flights=...), or gentler plans (a smaller slope)"
        )
    else:
        print(f"again        python -m benchbench {shlex.join(chosen.overrides)}")


def _draw(path: Path, found: Sequence[Candidate], target: float, typed: Sequence[str]) -> None:
    from benchbench.report.front import draw_front

    draw_front(
        path,
        found,
        target,
        f"What success costs: {' '.join(text for text in _told(typed) if ',' not in text)}",
    )


def _told(overrides: Sequence[str]) -> list[str]:
    """Overrides that say what is flown, not where results go or how many run at once."""
    return [text for text in overrides if not keys([text]) & set(NOT_DECISIVE)]


def _differing(one: Candidate, found: Sequence[Candidate]) -> str:
    """What it was asked for that not all others were."""
    common = set.intersection(*(set(other.overrides) for other in found))
    return " ".join(text for text in one.overrides if text not in common)


def _number(text: str) -> float:
    return float(text.partition("=")[2])


def _table(found: Sequence[Candidate], best: Sequence[Candidate], chosen: Candidate | None) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        [
            "travel_time_s",
            "flights",
            "succeeded",
            "proved",
            "wilson_low",
            "wilson_high",
            "front",
            "chosen",
            "overrides",
        ]
    )
    for one in sorted(found, key=lambda c: c.travel_time):
        writer.writerow(
            [
                one.travel_time,
                one.flights,
                one.succeeded,
                one.low,
                *one.interval,
                one in best,
                one is chosen,
                shlex.join(one.overrides),
            ]
        )
    return text.getvalue()
