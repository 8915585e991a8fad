"""The verdict on a plan, as a value: checks, reasons in plain words, numbers for the record, the flight."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from benchbench.certificate.check import Check
from benchbench.certificate.replay import Defects, Replay

Record = dict[str, Any]
NEAR = 0.5
"""Share of a limit from which its use is said in words."""


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
    contact_gaps: Mapping[str, float] | None = None
    contact_gaps_said: tuple[str, ...] | None = None
    touch_speed_mps: float | None = None
    touch_before_s: float | None = None
    passage_m: float | None = None
    max_rate_ratio: float | None = None
    stops: tuple[str, ...] | None = None
    reward_s: float | None = None
    costs: Mapping[str, float] | None = None
    gate_worst_miss_m: float | None = None
    gates: int | None = None
    gates_passed: int | None = None


@dataclass(frozen=True)
class Certificate:
    """Valid only if every check is; `flight` is the dense replay, `missed` what each interval misses; None when the plan could not be flown."""

    checks: tuple[Check, ...]
    measures: Measures
    flight: Replay | None
    missed: Defects | None = None

    @property
    def certified(self) -> bool:
        """Whether every limit is kept."""
        return not self.broken

    @property
    def broken(self) -> tuple[Check, ...]:
        """The checks that failed, in the order they were asked."""
        return tuple(check for check in self.checks if not check.ok)

    @property
    def reasons(self) -> tuple[str, ...]:
        """One sentence for each broken limit."""
        return tuple(check.reason for check in self.broken)

    @property
    def advice(self) -> str:
        """What to change: what the first broken check that knows a remedy says; "" without any.

        Only one is told: a plan that does not solve its problem need not be refined.
        """
        return next((check.advice for check in self.broken if check.advice), "")

    @property
    def uses(self) -> tuple[Check, ...]:
        """For each kind of limit the check that uses most of it, the fullest first."""
        fullest: dict[str, Check] = {}
        for check in self.checks:
            if check.used > (fullest[check.name].used if check.name in fullest else 0.0):
                fullest[check.name] = check
        return tuple(sorted(fullest.values(), key=lambda check: -check.used))

    def record(self) -> Record:
        """Flat numbers for a table row; what is absent or not finite is None."""
        numbers = {name: _finite(value) for name, value in vars(self.measures).items()}
        said: dict[str, str] = {}
        for check in self.uses:
            if check.used >= NEAR:  # at nodes and on the replay the same thing is asked for
                said.setdefault(check.what, check.use)
        uses = {
            "limits_used": {check.name: check.used for check in self.uses},
            "limits_used_said": tuple(said.values()),
        }
        return {
            "certified": self.certified, "reasons": self.reasons, "advice": self.advice, **numbers, **uses,
        }  # fmt: skip


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _finite(number) for name, number in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
