"""The figure of `race_figure.py` as Markdown tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from race_runs import METHODS, STOPPED, Results, Run, growth


def tables(results: Results, equal: int) -> str:
    """Return both tables: equal nodes, and the fewest nodes that are accurate."""
    same = {method: results.equal(method, equal) for method in METHODS}
    good = {method: results.accurate(method) for method in METHODS}
    head = f"{equal} nodes per gate: travel time s, CPU s, error of the replay mm"
    fine = "fewest nodes that replay to 1 cm: nodes per gate, travel time s, CPU s"
    first = _table(results.gates, same, _at_equal, lambda run: run.planned)
    second = _table(results.gates, good, _accurate, lambda run: run.accurate)
    return f"{head}\n\n{first}\n\n{fine}\n\n{second}"


def _table(
    gates: Sequence[int],
    lines: dict[str, list[Run]],
    cell: Callable[[Run], str],
    counts: Callable[[Run], bool],
) -> str:
    rows = [["gates", *lines]]
    for count in gates:
        found = {m: next((run for run in line if run.gates == count), None) for m, line in lines.items()}
        rows.append([str(count), *(cell(run) if run else "" for run in found.values())])
    exponents = [growth([run for run in line if counts(run)]) for line in lines.values()]
    rows.append(["CPU grows with (gates + 1)^", *("" if e is None else f"{e:.2f}" for e in exponents)])
    texts = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([texts[0], "|---" * len(rows[0]) + "|", *texts[1:]])


def _at_equal(run: Run) -> str:
    if run.status == STOPPED:
        return f"stopped after {run.cpu_s:g} s at {run.nodes} nodes"
    if not np.isfinite(run.travel_time_s):
        return run.status
    millimetres = 1e3 * run.drift_m
    error = f"{millimetres:.0f}" if millimetres > 100 else f"{millimetres:.2g}"
    said = f"{run.travel_time_s:.4f}, {run.cpu_s:.2f}, {error}"
    return (
        said
        if run.certified
        else f"{said}, **{'not certified' if run.status == 'uncertified' else run.status}**"
    )


def _accurate(run: Run) -> str:
    if run.accurate:
        return f"{run.nodes}: {run.travel_time_s:.4f}, {run.cpu_s:.2f}"
    if run.status == STOPPED:
        return f"stopped after {run.cpu_s:g} s at {run.nodes}"
    return f"not at {run.nodes}"
