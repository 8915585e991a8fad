"""One judge for all flights: was the ball met as planned, gently, carried, and nothing else touched?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchbench.flight.controller import PERIOD
from benchbench.flight.limits import FlightLimits
from benchbench.flight.loop import Log
from benchbench.flight.reference import Reference, entry, matrices, tip
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe

Flags = NDArray[np.bool_]
REASONS = {
    "lost": "it went further than a metre from the plan",
    "controller": "the controller failed, or what it learns from; or it commanded what is no number",
    "controller late": "commands took longer than until the next one",
    "no attachment": "the ball was never attached",
    "early": "the ball was attached before the plan is within reach",
    "late": "the ball was attached after the planned window",
    "too fast": "the end effector was too fast where the magnet began to act",
    "askew": "the nose was off the target's way there",
    "dropped": "the ball was not carried in the end",
    "touched": "the vehicle touched something else",
}
"""Why a flight is no success, by the name under which it is counted."""


@dataclass(frozen=True)
class Verdict:
    """Of one flight; NaN where there is nothing to measure.

    reasons         names of `REASONS` that hold; none for a success
    detail          what was touched, or the controller's error
    attached_s      s, first attachment
    touch_speed     m/s, and touch_heading rad, where the magnet began to act
    error_before    m, root mean square error of position before the ball is within reach, in the plan's time
    error_after     m, the same from the attachment to the end
    error_tip       m, of the end effector before
    """

    reasons: tuple[str, ...]
    detail: str
    attached_s: float
    touch_speed: float
    touch_heading: float
    error_before: float
    error_after: float
    error_tip: float

    @property
    def success(self) -> bool:
        """No reason against it."""
        return not self.reasons


def judge(log: Log, reference: Reference, airframe: Airframe, limits: FlightLimits) -> Verdict:
    """Judge a flight by the truth alone, and by the plan's own entry into the reach."""
    n, arm = len(log.time), (airframe.arm_offset, airframe.arm_length)
    wanted = reference.state[1 : n + 1]
    place, way = tip(log.state, *arm)
    planned, _ = tip(reference.state, *arm)
    begins = entry(reference, *arm)
    touch = _row(_within(place, log.ball[:, :3], reference) & (log.time >= 0))
    caught = _row(log.attached)
    attached_s = np.nan if caught is None else float(log.time[caught])
    speed = heading = np.nan
    if touch is not None:
        speed = float(np.linalg.norm(way[touch] - log.ball[touch, 3:]))
        heading = _heading(log.state[touch], reference.target[touch + 1, 3:], limits.slow)
    whole = n == len(reference.time) - 1 and not log.broken
    tests = {
        "lost": log.broken == "lost",
        "controller": log.broken not in ("", "lost"),
        "controller late": np.sum(log.controller_cpu > PERIOD)
        > limits.controller_late * len(log.controller_cpu),
        "no attachment": whole and caught is None,
        "early": attached_s < begins - limits.early,
        "late": attached_s > reference.window[1] + limits.late,
        "too fast": speed > limits.touch_speed,
        "askew": heading > limits.heading,
        "dropped": whole and caught is not None and not log.attached[-1],
        "touched": any(log.touched),
    }
    error = np.linalg.norm(log.state[:, :3] - wanted[:, :3], axis=1)
    until = log.time[touch] if touch is not None else reference.window[0]
    before, after = (log.time >= 0) & (log.time < until), log.time >= attached_s
    at_tip = np.linalg.norm(place - planned[1 : n + 1], axis=1)
    detail = log.broken if tests["controller"] else " ".join(sorted({*" ".join(log.touched).split()}))
    return Verdict(
        tuple(name for name, holds in tests.items() if holds), detail, attached_s, speed, heading,
        _rms(error[before]), _rms(error[after]), _rms(at_tip[before]),
    )  # fmt: skip


def _within(place: Array, centre: Array, reference: Reference) -> Flags:
    return np.asarray(np.linalg.norm(place - centre, axis=1) - reference.ball_radius <= reference.reach)


def _row(holds: Flags) -> int | None:
    return int(np.argmax(holds)) if holds.any() else None


def _heading(state: Array, way: Array, slow: float) -> float:
    """Angle in rad between the nose and a way, both level; NaN for a target that hardly moves."""
    if np.hypot(way[0], way[1]) < slow:
        return float("nan")
    nose = matrices(state[None, 3:7])[0, :, 0]
    return float(abs(np.arctan2(nose[0] * way[1] - nose[1] * way[0], nose[:2] @ way[:2])))


def _rms(error: Array) -> float:
    return float(np.sqrt(np.mean(error**2))) if len(error) else float("nan")
