"""Run one case of the matrix: its answer, and its solve times paired with the reference; or its flights."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from benchbench.ground.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.reference import Reference
from benchbench.planning.case import Case
from benchbench.run import config, pipeline
from benchbench.run.flying import campaign

ANSWER = ("status", "certified", "travel_time_s", "objective", "iterations", "evaluations")
"""Columns of the record that are compared."""
FLOWN = ("flights", "flights_succeeded", "flight_error_before_m", "flight_error_after_m")
"""Those of a case that is flown."""
Measured = dict[str, Any]


def measure(overrides: Sequence[str], repeats: int, reference: Reference) -> Measured:
    """Return the answer and `ratios`, one per repeat: solve CPU / mean CPU of the reference just before and after.

    The first solve gives the answer and warms up. A case that asks for flights is flown and not timed: columns `FLOWN`.
    Raises BadInput; Unavailable for flights without what they need.
    """
    cfg, chosen = config.composed(*overrides)
    asked, case = campaign(cfg, chosen), config.build(cfg, chosen)
    if asked:
        record = pipeline.run(case, campaign=asked).record
        return {name: record[name] for name in FLOWN}
    if not isinstance(case, Case):
        raise BadInput("scenario", "a ready-made MPCC was chosen", "a flight")
    record = pipeline.run(case).record
    ratios = []
    before = reference.cpu_s()
    for _ in range(repeats):
        spent = _solve_cpu(case)
        after = reference.cpu_s()
        ratios.append(2.0 * spent / (before + after))
        before = after
    return {name: record[name] for name in ANSWER} | {"ratios": ratios}


def _solve_cpu(case: Case) -> float:
    """CPU seconds of everything but construction and certificates, whatever the backend says of its own time."""
    ledger = Ledger(case.time_limit)
    began = time.process_time()
    case.strategy.solve(case, ledger)
    return time.process_time() - began - ledger.build_cpu - ledger.judging_cpu
