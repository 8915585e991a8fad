"""The end of a suite: what each method did on its tasks, as text and as a file beside the table."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from datetime import datetime
from typing import Any

from benchbench.analysis.suite import CPU, Outcome, Row, above_bound, cpu, outcome
from benchbench.run.fitting import fitted
from benchbench.run.overrides import keys
from benchbench.run.settings import NOT_DECISIVE
from benchbench.run.suites import Suite
from benchbench.storage import provenance
from benchbench.storage.files import write_bytes
from benchbench.sweep.rows import rows_of
from benchbench.sweep.sweep import Swept

FOLDER = "suites"
"""In the folder of results."""
COLUMNS = (
    "scenario", "status", "reasons", "certified", "travel_time_s", "reward_s", "costs", "objective", "intervals", "best_known_s",
    "best_known_objective", "gap_percent", "lower_bound_s", "limited_by", "level_bound_s", *CPU,
    "task_hash", "config_hash", "run_id",
)  # fmt: skip
"""What the file says of each task."""
Task = tuple[Swept, Row | None]


def conclude(name: str, suite: Suite, quick: bool, swept: Sequence[Swept]) -> None:
    """Print the summary of a suite that has run, and write it; raises BadInput where it cannot be written."""
    rows = rows_of(swept, COLUMNS)
    methods: dict[tuple[str, ...], list[Task]] = {}
    for one in swept:
        row = rows.get(one.place.labels["config_hash"]) if one.place else None
        methods.setdefault(_method(one), []).append((one, row))
    told = {how: outcome([row for _, row in tasks]) for how, tasks in methods.items()}
    title = f"suite {name}, version {suite.version}{', a tenth of it' if quick else ''}: {suite.title}"
    print(fitted(title, 2))
    for how, tasks in methods.items():
        for line in _text(how, told[how], tasks):
            print(fitted(line, 15) if "# " not in line else line)
    root = next((one.place.root for one in swept if one.place), None)
    if root is None:
        return
    path = root / FOLDER / f"{name}_{datetime.now():%Y-%m-%d_%H-%M-%S-%f}.json"
    content = {
        "suite": name, "version": suite.version, "title": suite.title, "quick": quick,
        "versions": provenance.collect(),
        "methods": [_content(how, told[how], tasks) for how, tasks in methods.items()],
    }  # fmt: skip
    write_bytes(path, (json.dumps(content, indent=1, allow_nan=False) + "\n").encode())
    print(f"{'summary':<13}  {path}")


def _method(one: Swept) -> tuple[str, ...]:
    """Overrides that say how a task is planned, not which."""
    decisive = (text for text in one.overrides if not keys([text]) & set(NOT_DECISIVE))
    return tuple(text for text in decisive if not keys([text]) & {"scenario", "seed"})


def command(one: Swept) -> str:
    """Return the command that runs one task again."""
    told = [text for text in one.overrides if not keys([text]) & set(NOT_DECISIVE)]
    return f"python -m benchbench {shlex.join(told)}"


def _text(how: Sequence[str], told: Outcome, tasks: Sequence[Task]) -> Iterator[str]:
    what = "travel time" if any(row and row["intervals"] is not None for _, row in tasks) else "objective"
    yield from (f"{label:<13}  {text}" for label, text in _lines(how, told, what).items())
    for one, row in tasks:
        if row is None or row["certified"] is not True:
            yield f"{command(one)}  # {row['status'] if row else 'bad_input'}: {why(row)}"


def why(row: Row | None) -> str:
    """Return the first reason, in a line; the record has all."""
    reasons = (row["reasons"] or ()) if row else ()
    more = f", and {len(reasons) - 1} more" if len(reasons) > 1 else ""
    return " ".join(reasons[0].split()) + more if reasons else "it was refused, see above"


def _lines(how: Sequence[str], told: Outcome, what: str) -> dict[str, str]:
    """What is said of a method; what: that which is to be least. Problems that are no flights have no proven bound."""
    rate = told.certified
    interval = f"95 % Wilson interval {100 * rate.low:.1f} to {100 * rate.high:.1f} %"
    rest = ", ".join(f"{count} {status}" for status, count in told.statuses.items() if status != "certified")
    within = f"95 % within {_said(told.cpu_most_s, 's')}"
    bound = {
        "proven bound": f"median {_said(told.bound_median, '%', '+')} above that of {told.bounded} tasks, "
        f"{_said(told.level_median, '%', '+')} above that of level flights"
    }
    return {
        "method": " ".join(how) or "as the program has it",
        "certified": f"{rate.successes} of {rate.runs}  ({interval}){f'; {rest}' if rest else ''}",
        "CPU": f"median {_said(told.cpu_median_s, 's')}, {within}  (build, solve and check)",
        what: _compared(told),
        **(bound if what == "travel time" else {}),
    }


def _compared(told: Outcome) -> str:
    median, worst = (_said(gap, "%", "+") for gap in (told.gap_median, told.gap_worst))
    kept = f"; {told.better} are the best known now, `benchbench best` keeps them" if told.better else ""
    return f"median {median}, worst {worst} above the best known of {told.compared} tasks{kept}"


def _said(value: float | None, unit: str, sign: str = "") -> str:
    return "unknown" if value is None else f"{value:{sign}.3g} {unit}"


def _content(how: Sequence[str], told: Outcome, tasks: Sequence[Task]) -> dict[str, Any]:
    return {"method": list(how), **asdict(told), "tasks": [_task(one, row) for one, row in tasks]}


def _task(one: Swept, row: Row | None) -> dict[str, Any]:
    if row is None:
        return {"command": command(one), "status": "bad_input"}
    seconds = cpu(row)
    more = {"cpu_s": seconds if math.isfinite(seconds) else None, "bound_percent": above_bound(row)}
    return {"command": command(one), **{name: row[name] for name in COLUMNS}, **more}
