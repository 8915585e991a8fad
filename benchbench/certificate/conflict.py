"""Which demands of a handover contradict each other, where the bounds prove that no flight keeps all of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchbench.certificate.contact_bound import ALL, Ask, Visit
from benchbench.certificate.course import Course
from benchbench.certificate.handover_bound import visit
from benchbench.certificate.leg import yaw_rate
from benchbench.certificate.speed_bound import sequence_bound
from benchbench.certificate.turning import ByRate
from benchbench.ground.arrays import Array
from benchbench.ocp.handover import Handover
from benchbench.ocp.model import AXES, Model, Plant, travels
from benchbench.ocp.motion import sample
from benchbench.ocp.stop import Stop

TRIED: tuple[frozenset[Ask], ...] = (
    frozenset(("stay",)), frozenset(("follow",)), frozenset(("come",)), frozenset(("turn",)),
    frozenset(("come", "stay")), frozenset(("come", "go")), frozenset(("come", "stay", "go")), ALL,
)  # fmt: skip
"""Sets of demands, the smallest first: the first one that no flight keeps is what is told."""
STEP = 0.01
"""s between the instants at which a target is looked at to say how fast it is."""


@dataclass(frozen=True)
class Conflict:
    """Two demands that no flight keeps both, in words: what is asked, and what the vehicle can do."""

    asked: str
    able: str


def conflict(scenario: Handover, stop: Stop, model: Model, plant: Plant) -> Conflict | None:
    """Return the demands on one stop that contradict each other for every travel time allowed; None where none are proved to."""
    whole, latest = visit(scenario, stop, model, plant, ByRate(yaw_rate(model))), scenario.travel_time[1]
    start = sequence_bound(scenario, (), model, plant)
    if stop.heading_error is None or not np.isfinite(yaw_rate(model)):
        whole = replace(whole, turning=None)
    for asks in TRIED:
        part = replace(whole, asks=asks)
        if not asks & {"turn", "follow"}:
            part = replace(part, turning=None)
        elif whole.turning is None:
            continue
        if not part.possible(start, latest):
            return _told(part, start, latest)
    return None


def conflicts(scenario: Handover, model: Model, plant: Plant) -> Iterator[tuple[Stop, Conflict]]:
    """Yield what contradicts itself at each stop that has to be made."""
    for stop in scenario.itinerary.stops if travels(model) else ():
        if not scenario.itinerary.may_skip(stop) and (found := conflict(scenario, stop, model, plant)):
            yield stop, found


def _told(part: Visit, start: float, latest: float) -> Conflict:
    lasts = part.stop.lasts(start)
    time = np.arange(0.0, max(latest - lasts, STEP), STEP)
    (there, _), (then, moving) = sample(part.stop.target, time), sample(part.stop.target, time + lasts)
    if part.asks == {"follow"}:
        return _turning(part, moving, lasts)
    if part.asks == {"stay"}:
        return _moving(part, np.min(np.abs(then - there), axis=0), lasts)
    if part.asks == {"turn"}:
        rate = part.turning.rate if part.turning else np.inf
        return Conflict(
            f"the nose has to point along the target's way within {part.error:g} rad",
            f"it turns at {rate:g} rad/s at most, too slowly to be there and back in {latest:g} s",
        )
    if part.asks == {"come"}:
        return _away(part, there, time, latest)
    said = {"come": "come near the target", "stay": "stay near it", "go": "be at the end"}
    asked = [text for ask, text in said.items() if ask in part.asks]
    if "turn" in part.asks:
        asked.append("point along the target's way meanwhile")
    return Conflict(
        f"the vehicle has to {' and '.join(asked)} within {latest:g} s", f"it flies {_speeds(part)} at most"
    )


def _speeds(part: Visit) -> str:
    return ", ".join(f"{v:g} m/s along {axis}" for axis, v in zip(AXES, part.speed, strict=True))


def _away(part: Visit, target: Array, time: Array, latest: float) -> Conflict:
    """The axis on which the target is always farthest from where the vehicle can be."""
    back, ahead = part.first.way(time)
    way = target - part.first.place
    short = np.maximum(way - ahead, -way - back) - part.reach
    axis = int(np.argmax(np.min(short, axis=0)))
    nearest = float(np.min(short[:, axis]))
    far = (
        f"is at least {nearest:.3g} m too far along {AXES[axis]}"
        if nearest > 0
        else "is never near on all axes at once"
    )
    return Conflict(f"within {latest:g} s the target {far}", f"the vehicle flies {_speeds(part)} at most")


def _moving(part: Visit, way: Array, lasts: float) -> Conflict:
    """The axis on which the target gets away most."""
    axis = int(np.argmax(way - 2 * part.reach - part.speed * lasts))
    return Conflict(
        f"the target moves at {way[axis] / max(lasts, STEP):.3g} m/s or more along {AXES[axis]} while contact lasts {lasts:.3g} s",
        f"the vehicle flies {part.speed[axis]:g} m/s along {AXES[axis]} at most",
    )


def _turning(part: Visit, moving: Array, lasts: float) -> Conflict:
    way = Course.of(moving, part.error).way
    count = max(int(lasts / STEP), 1)
    turn = np.min(np.abs(way[count:] - way[:-count])) / (count * STEP) if len(way) > count else 0.0
    rate = part.turning.rate if part.turning else np.inf
    return Conflict(
        f"the target turns at {turn:.3g} rad/s while contact lasts {lasts:.3g} s",
        f"the vehicle's yaw rate is limited to {rate:g} rad/s while heading is asked within {part.error:g} rad",
    )
