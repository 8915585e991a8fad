"""The gates: a measured entry against its baseline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any, Literal

from scipy.stats import mannwhitneyu

from benchbench.sweep.regression.matrix import Gates

Verdict = Literal["same", "better", "WORSE"]
SLACK = {"iterations": 3, "evaluations": 15}
"""What small counts may rise in any case."""


@dataclass(frozen=True)
class Change:
    """One compared number of one case; `change` is relative, None where it makes no sense."""

    case: str
    what: str
    was: str
    now: str
    change: float | None
    verdict: Verdict
    note: str = ""

    @property
    def moved(self) -> bool:
        """The number is not what it was, perhaps within its gate."""
        return self.was != self.now or bool(self.change)


def compare(case: str, was: Mapping[str, Any], now: Mapping[str, Any], gates: Gates) -> list[Change]:
    """Return a line for each gate."""
    if "flights" in was or "flights" in now:
        return _flights(case, was, now, gates)
    return [
        _certified(case, was, now),
        _number(case, "travel_time_s", was, now, gates.travel_time),
        _number(case, "objective", was, now, gates.objective),
        _number(case, "iterations", was, now, gates.iterations),
        _number(case, "evaluations", was, now, gates.evaluations),
        _solve_time(case, was["ratios"], now["ratios"], gates),
    ]


def unavailable(case: str, was: Mapping[str, Any], why: str) -> Change:
    """Return the line of flights that could not be flown here: told, and no regression."""
    return Change(case, "flights", _succeeded(was), "unavailable", None, "same", why)


def _flights(case: str, was: Mapping[str, Any], now: Mapping[str, Any], gates: Gates) -> list[Change]:
    """Successes exactly: the worlds are the same. Another number of flights says nothing of them."""
    old, new = (entry.get("flights_succeeded") or 0 for entry in (was, now))
    same = was.get("flights") == now.get("flights")
    verdict: Verdict = "same" if same and old == new else "better" if same and new > old else "WORSE"
    return [
        Change(case, "flights", _succeeded(was), _succeeded(now), None, verdict, "exact"),
        _number(case, "flight_error_before_m", was, now, gates.tracking),
        _number(case, "flight_error_after_m", was, now, gates.tracking),
    ]


def _succeeded(entry: Mapping[str, Any]) -> str:
    if entry.get("flights") is None:
        return "none"
    return f"{entry['flights_succeeded']} of {entry['flights']}"


def _certified(case: str, was: Mapping[str, Any], now: Mapping[str, Any]) -> Change:
    verdict: Verdict = "same"
    if was["certified"] != now["certified"]:
        verdict = "better" if now["certified"] else "WORSE"
    return Change(case, "status", str(was["status"]), str(now["status"]), None, verdict)


def _number(case: str, what: str, was: Mapping[str, Any], now: Mapping[str, Any], share: float) -> Change:
    old, new = was.get(what), now.get(what)
    if old is None or new is None:
        verdict: Verdict = "WORSE" if old is not None else "same" if new is None else "better"
        return Change(case, what, _text(old), _text(new), None, verdict)
    room = share * abs(old) + SLACK.get(what, 0)
    verdict = "WORSE" if new > old + room else "better" if new < old - room else "same"
    change = (new - old) / abs(old) if old else None
    return Change(case, what, _text(old), _text(new), change, verdict, f"at most +{share:.1%} allowed")


def _solve_time(case: str, was: list[float], now: list[float], gates: Gates) -> Change:
    """Worse if the ratios are above `solve_factor` times the old ones (one-sided Mann-Whitney U test)."""
    factor = gates.solve_factor
    level = 1.0 - gates.confidence
    slower = mannwhitneyu(now, [factor * ratio for ratio in was], alternative="greater").pvalue
    faster = mannwhitneyu([factor * ratio for ratio in now], was, alternative="less").pvalue
    verdict: Verdict = "WORSE" if slower < level else "better" if faster < level else "same"
    old, new = median(was), median(now)
    note = f"factor {factor:g} allowed, p = {slower:.2g} that it is not exceeded"
    return Change(case, "solve / reference", f"{old:.3f}", f"{new:.3f}", new / old - 1.0, verdict, note)


def _text(value: float | int | None) -> str:
    return "none" if value is None else f"{value:.6g}"
