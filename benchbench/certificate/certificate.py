"""The verdict on a plan, as a value: checks, reasons in plain words, numbers for the record, the flight."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchbench.arrays import Array
from benchbench.certificate.advice import advice
from benchbench.certificate.replay import Replay

Record = dict[str, bool | float | str | tuple[str, ...] | None]


@dataclass(frozen=True)
class Check:
    """One limit: its `value` against `limit` in `unit`; `reason` says in words why it failed, else ""."""

    name: str
    value: float
    limit: float
    unit: str
    ok: bool
    reason: str = ""


@dataclass(frozen=True)
class Measures:
    """Numbers of the record, SI units; None where there is nothing to measure."""

    max_violation: float | None = None
    max_complementarity: float | None = None
    max_product: float | None = None
    replay_defect_position_m: float | None = None
    replay_defect_angle_rad: float | None = None
    replay_drift_position_m: float | None = None
    replay_end_error_m: float | None = None
    contact_start_s: float | None = None
    contact_end_s: float | None = None
    contact_steps: float | None = None
    contact_duration_s: float | None = None
    contact_max_distance_m: float | None = None
    contact_max_speed_gap_mps: float | None = None
    contact_max_heading_error_rad: float | None = None
    max_rate_ratio: float | None = None
    stops: tuple[str, ...] | None = None
    reward_s: float | None = None
    gate_worst_miss_m: float | None = None
    gates: int | None = None
    gates_passed: int | None = None


@dataclass(frozen=True)
class Certificate:
    """Valid only if every check is; `flight` is the dense replay, None when the plan could not be flown."""

    checks: tuple[Check, ...]
    measures: Measures
    flight: Replay | None

    @property
    def certified(self) -> bool:
        """Whether every limit is kept."""
        return all(check.ok for check in self.checks)

    @property
    def reasons(self) -> tuple[str, ...]:
        """One sentence for each broken limit."""
        return tuple(check.reason for check in self.checks if not check.ok)

    def record(self) -> Record:
        """Flat numbers for a table row; what is absent or not finite is None."""
        numbers = {name: _finite(value) for name, value in vars(self.measures).items()}
        told = advice(check.name for check in self.checks if not check.ok)
        return {"certified": self.certified, "reasons": self.reasons, "advice": told, **numbers}


def at_most(
    name: str, what: str, value: float, limit: float, unit: str, where: str = "", verb: str = "reaches"
) -> Check:
    """Check value <= limit; NaN fails. `what` is the subject of the reason, `where` its place or time."""
    if math.isnan(value):
        return Check(name, value, limit, unit, False, f"{what} is not a number{where}")
    reason = f"{what} {verb} {_number(value, unit)}{where}, allowed {_number(limit, unit)}"
    return Check(name, value, limit, unit, value <= limit, "" if value <= limit else reason)


def at_least(name: str, what: str, value: float, limit: float, unit: str, slack: float = 0.0) -> Check:
    """Check value >= limit - slack; NaN fails."""
    ok = value >= limit - slack
    reason = f"{what} is only {_number(value, unit)}, required {_number(limit, unit)}"
    return Check(name, value, limit, unit, ok, "" if ok else reason)


def worst(values: Array) -> tuple[float, tuple[int, ...]]:
    """Largest value of an array and where it stands; NaN counts as largest."""
    at = np.unravel_index(np.argmax(np.where(np.isnan(values), np.inf, values)), values.shape)
    return float(values[at]), tuple(int(i) for i in at)


def _number(value: float, unit: str) -> str:
    return f"{value:.6g} {unit}".rstrip() if unit != "1" else f"{value:.6g}"


def _finite(value: float | tuple[str, ...] | None) -> float | tuple[str, ...] | None:
    return None if isinstance(value, float) and not math.isfinite(value) else value
