"""A flight after a target that has to be predicted: seen, predicted, planned anew, until the magnet's reach begins."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import final

import numpy as np

from benchbench.flight.course import Control
from benchbench.flight.from_plan import TAIL, at_rest
from benchbench.flight.predictor import Predictor
from benchbench.flight.reference import Reference, tip
from benchbench.flight.replanning import Replanning, Way
from benchbench.flight.sight import Sight
from benchbench.flight.statics import hover
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe
from benchbench.ocp.motion import Motion, sample

PERIOD = 0.1
"""s from one plan to the next."""
AHEAD = 0.06
"""s after it was asked for, a plan begins: where the one before is by then, however long planning took."""
LAST = 0.1
"""s before the planned entry into the magnet's reach, from which on the plan stays."""
LONGER = 4.0
"""s that a flight may take longer than the plan for a target that is known."""


@final
class Pursuit:
    """Of one flight; costs: CPU s of each plan, predicting included; refused: how many of them were none."""

    def __init__(
        self, replanning: Replanning, predictor: Predictor, sight: Sight, waiting: Reference, airframe: Airframe,
        prepare: Callable[[Reference, Control | None], Control],
    ) -> None:  # fmt: skip
        """Hover at the start until the first plan begins, at 0 s; prepare: a controller for a reference, from who flew before."""
        self.replanning, self.predictor, self.sight = replanning, predictor, sight
        self.waiting, self.airframe, self.prepare = waiting, airframe, prepare
        self._reference, self._believed, self._step = waiting, waiting, prepare(waiting, None)
        self.ask, self.entry = -AHEAD, np.inf
        self.way: Way | None = None
        self.begun, self.coming = 0.0, np.inf
        self.costs: list[float] = []
        self.refused = 0

    @property
    def reference(self) -> Reference:
        """What was followed until now, and is from now on, with the true target: the judge's."""
        return self._reference

    def control(self, now: float) -> Control:
        """Plan where it is time to, and take over what was planned before."""
        if now >= self.coming - 1e-9:
            self.coming, self._step = np.inf, self.prepare(self._believed, self._step)
        if now >= self.ask - 1e-9 and now + AHEAD < self.entry - LAST:
            self.ask += PERIOD
            self._plan(now, now + AHEAD)
        return self._step

    def _plan(self, now: float, begin: float) -> None:
        before = time.thread_time()
        target = self.predictor.predict(self.sight.seen(now, begin))
        if target is None:
            raise ValueError("the predictor gave no motion")
        way = self.replanning.plan(target, self.way, begin - self.begun if self.way else 0.0)
        self.costs.append(time.thread_time() - before)
        if way is None or begin + way.seconds + TAIL > self.waiting.time[-1]:
            self.refused += 1
            return
        self.way, self.begun, self.coming = way, begin, begin
        self.entry = begin + self._entry(way, target)
        self._reference = joined(self._reference, self.waiting.target, begin, way, self.airframe)
        self._believed = foreseen(self._reference, self._believed, target, begin)

    def _entry(self, way: Way, target: Motion) -> float:
        """When the plan comes within reach of what was predicted, s from its beginning; at the latest with the contact."""
        times: Array = STEP * np.arange(max(round(way.window[0] / STEP), 1), dtype=float)
        place, _ = tip(way.state[: len(times)], self.airframe.arm_offset, self.airframe.arm_length)
        centre = sample(target, times)[0] - [0, 0, self.waiting.ball_radius]
        near = np.linalg.norm(place - centre, axis=1) - self.waiting.ball_radius <= self.waiting.reach
        return float(times[np.argmax(near)]) if near.any() else way.window[0]


def hovering(reference: Reference, target: Motion, late: float, airframe: Airframe) -> Reference:
    """Stay at a reference's start until `LONGER` after its end, with the true target, which comes so many s late."""
    count = len(reference.time) + round(LONGER / STEP)
    time: Array = reference.time[0] + STEP * np.arange(count, dtype=float)
    start = reference.state[0]
    return replace(
        reference, time=time, state=np.tile(start, (count, 1)), acceleration=np.zeros((count, 3)),
        inputs=np.tile(hover(airframe, float(start[7])), (count, 1)),
        target=np.hstack(sample(target, time - late)), travel_time=float(time[-1]) - TAIL,
    )  # fmt: skip


def foreseen(reference: Reference, before: Reference, target: Motion, begin: float) -> Reference:
    """The same with the target as it is predicted from `begin` s on, before that as it was before: what a controller may know."""
    row = reference.row(begin)
    ahead = np.hstack(sample(target, reference.time[row:] - begin))
    return replace(reference, target=np.vstack([before.target[:row], ahead]))


def joined(old: Reference, target: Array, begin: float, way: Way, airframe: Airframe) -> Reference:
    """The old reference until a way begins, then the way, then hovering at its end; target: of all times there may be."""
    row, after = old.row(begin), round(TAIL / STEP)
    same = 1.0 if old.state[row, 3:7] @ way.state[0, 3:7] >= 0 else -1.0
    state = way.state * np.where((np.arange(15) >= 3) & (np.arange(15) < 7), same, 1.0)
    end = at_rest(state[-1])
    held = np.tile(hover(airframe, float(end[7])), (after, 1))
    count = row + len(state) + after
    return replace(
        old, time=old.time[0] + STEP * np.arange(count, dtype=float),
        state=np.vstack([old.state[:row], state, np.tile(end, (after, 1))]),
        inputs=np.vstack([old.inputs[:row], way.inputs, held]),
        acceleration=np.vstack([old.acceleration[:row], way.acceleration, np.zeros((after, 3))]),
        target=target[:count], window=(begin + way.window[0], begin + way.window[1]),
        travel_time=begin + way.seconds,
    )  # fmt: skip
