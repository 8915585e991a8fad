"""What record and table of flights say of many flights of one plan."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchbench.analysis.binomial import CONFIDENCE, exact_bound
from benchbench.analysis.wilson import wilson
from benchbench.flight.campaign import Campaign, Flown
from benchbench.flight.limits import FlightLimits
from benchbench.flight.loop import Log
from benchbench.flight.reference import Reference
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array
from benchbench.ground.families import FLOWN
from benchbench.ocp.airframe import Airframe


@dataclass(frozen=True)
class Flights:
    """All flights of a plan, what they were judged by, what the record says of them, and their table as CSV."""

    airframe: Airframe
    limits: FlightLimits
    reference: Reference
    flown: Sequence[Flown]
    columns: dict[str, Any]
    table: str


def flights(campaign: Campaign, airframe: Airframe, reference: Reference, flown: Sequence[Flown]) -> Flights:
    """Return flights with what is said of them."""
    return Flights(
        airframe,
        campaign.limits,
        reference,
        flown,
        columns(campaign, flown),
        table(flown, campaign.names["predictor"]),
    )


def columns(campaign: Campaign, flown: Sequence[Flown]) -> dict[str, Any]:
    """Columns of the record."""
    verdicts = [one.verdict for one in flown]
    successes = sum(verdict.success for verdict in verdicts)
    bounds = wilson(successes, len(flown), CONFIDENCE)
    costs = np.concatenate([one.log.controller_cpu for one in flown]) if flown else np.zeros(0)
    speeds = np.array([verdict.touch_speed for verdict in verdicts])
    return {
        **{name: campaign.names[name] for name in FLOWN},
        "flights": len(flown), "flights_succeeded": successes,
        "flights_low_exact": exact_bound(successes, len(flown)),
        "flights_low": bounds.low, "flights_high": bounds.high,
        "flight_reasons": dict(Counter(reason for verdict in verdicts for reason in verdict.reasons)),
        "flight_error_before_m": _middle([verdict.error_before for verdict in verdicts]),
        "flight_error_after_m": _middle([verdict.error_after for verdict in verdicts]),
        "flight_touch_p50_mps": _share(speeds, 50), "flight_touch_p95_mps": _share(speeds, 95),
        "controller_cpu_p50_s": _share(costs, 50), "controller_cpu_p99_s": _share(costs, 99),
        "real_time_factor": _middle([_factor(one.log) for one in flown]),
        **_replanned(flown),
    }  # fmt: skip


def _replanned(flown: Sequence[Flown]) -> dict[str, Any]:
    """Nothing where no plan was made in a flight."""
    costs = np.concatenate([np.zeros(0), *(one.replan_cpu for one in flown)])
    if not len(costs):
        return {}
    return {
        "replans": len(costs), "replans_refused": sum(one.refused for one in flown),
        "replan_cpu_p50_s": _share(costs, 50), "replan_cpu_p99_s": _share(costs, 99),
    }  # fmt: skip


def table(flown: Sequence[Flown], predictor: str) -> str:
    """Return a CSV file of one row per flight; what is no number is empty."""
    rows = [_row(one, predictor) for one in flown]
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["flight"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _row(one: Flown, predictor: str) -> dict[str, Any]:
    verdict, cost, reference = one.verdict, one.log.controller_cpu, one.reference
    plans = np.array(one.replan_cpu)
    numbers = {
        "attached_s": verdict.attached_s, "touch_speed_mps": verdict.touch_speed, "touch_heading_rad": verdict.touch_heading,
        "error_before_m": verdict.error_before, "error_after_m": verdict.error_after, "error_tip_m": verdict.error_tip,
        "controller_cpu_p50_s": _share(cost, 50), "controller_cpu_p99_s": _share(cost, 99),
        "real_time_factor": _factor(one.log), "learning_cpu_s": one.learning_cpu,
        "flown_s": len(one.log.time) * STEP, "window_start_s": reference.window[0], "window_end_s": reference.window[1],
        "replan_cpu_p50_s": _share(plans, 50), "replan_cpu_max_s": _share(plans, 100),
    }  # fmt: skip
    drawn = {
        f"mismatch.{name}": _text(value) for name, value in one.mismatch if name not in ("seed", "rigid")
    }
    told = {
        "flight": one.number,
        "mismatch_seed": one.mismatch.seed,
        "success": verdict.success,
        "predictor": predictor,
        "replans": len(plans),
        "replans_refused": one.refused,
    }
    return {
        **told,
        "reasons": "; ".join(verdict.reasons),
        "detail": verdict.detail,
        **{name: _text(value) for name, value in numbers.items()},
        **drawn,
    }


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return " ".join(map(_text, value.tolist()))
    return "" if value is None or not np.isfinite(value) else f"{value:.6g}"


def _factor(log: Log) -> float:
    """Simulated over CPU seconds."""
    return len(log.time) * STEP / log.cpu if log.cpu > 0 else float("nan")


def _middle(numbers: list[float]) -> float | None:
    return _share(np.array(numbers), 50)


def _share(numbers: Array, percent: float) -> float | None:
    """A percentile of what is a number; None of nothing."""
    found = numbers[np.isfinite(numbers)]
    return float(np.percentile(found, percent)) if len(found) else None
