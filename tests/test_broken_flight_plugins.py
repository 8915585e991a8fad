"""Deliberately broken worlds, controllers, autopilots, residuals, payloads and predictors: each must fail the named check of its suite."""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from benchbench.conformance.checks import autopilots, controllers, payloads, predictors, residuals, worlds
from benchbench.flight.autopilot import Autopilot
from benchbench.flight.controller import Controller, Known
from benchbench.flight.mismatch import Drawn
from benchbench.flight.payload import Payload, Weighing
from benchbench.flight.predictor import Predictor, Seen
from benchbench.flight.reference import Reference
from benchbench.flight.residual import Correction, Learned, Residual, Sample
from benchbench.flight.rig import Rig
from benchbench.flight.sensed import Command, Sensed, Triple
from benchbench.flight.world import Actuators, Truth, World
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe
from benchbench.ocp.motion import Motion
from benchbench_plugins.autopilots.px4 import Px4
from benchbench_plugins.controllers.nmpc import Nmpc
from benchbench_plugins.predictors.constant_velocity import ConstantVelocity
from benchbench_plugins.predictors.known import Known as Told
from benchbench_plugins.residuals.filtered import Filtered
from benchbench_plugins.residuals.observer import Observer
from benchbench_plugins.worlds.mujoco import Mujoco

pytest.importorskip("mujoco", reason="mujoco is not installed")
pytest.importorskip("daqp", reason="daqp is not installed")

# ---------------------------------------------------------------- worlds


@dataclass
class SpoiltWorld(World):
    """MuJoCo with something changed before it begins, or in what it is told."""

    begin: Callable[..., tuple[Any, ...]] = lambda *given: given
    told: Callable[[Actuators], Actuators] = lambda actuators: actuators

    def prepare(
        self, reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn
    ) -> Callable[[Actuators], Truth]:
        step = Mujoco().prepare(*self.begin(reference, airframe, rig, mismatch))
        return lambda actuators: step(self.told(actuators))


def wrong_arm(actuators: Actuators) -> Actuators:
    angle, rate, torque = actuators.arm
    return Actuators(actuators.motors, (angle, rate, -torque))


def swapped_motors(actuators: Actuators) -> Actuators:
    return Actuators(actuators.motors[[1, 0, 2, 3]], actuators.arm)


def far_magnet(reference: Reference, *rest: Any) -> tuple[Any, ...]:
    return (replace(reference, reach=1.5 * reference.reach), *rest)


def still_stand(reference: Reference, *rest: Any) -> tuple[Any, ...]:
    return (replace(reference, target=np.tile(reference.target[0], (len(reference.time), 1))), *rest)


def deaf(reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn) -> tuple[Any, ...]:
    return reference, airframe, rig, mismatch.model_copy(update={"mass": 0.0})


def strong(reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn) -> tuple[Any, ...]:
    return reference, airframe, rig.model_copy(update={"motor_force": (0.0, 12.0)}), mismatch


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (SpoiltWorld(told=wrong_arm), worlds.check_motion, "arm's rate"),
        (SpoiltWorld(told=swapped_motors), worlds.check_motion, "changes by"),
        (SpoiltWorld(far_magnet), worlds.check_magnet, "is lifted"),
        (SpoiltWorld(still_stand), worlds.check_stand, "from where its stand"),
        (SpoiltWorld(deaf), worlds.check_mismatch, "mass does not"),
        (SpoiltWorld(strong), worlds.check_mismatch, "their limits"),
    ],
)
def test_spoilt_world(broken: World, check: Callable[[World], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken)


# ---------------------------------------------------------------- controllers


@dataclass
class SpoiltController(Controller):
    """The NMPC with something changed in what it knows, hears or says."""

    before: Callable[[Sensed, float], tuple[Sensed, float]] = lambda sensed, now: (sensed, now)
    after: Callable[[Command], Command] = lambda command: command
    deaf: bool = False
    light: bool = False

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        if self.light:
            weighing = _nothing
        step = Nmpc().prepare(known, Filtered(0.0) if self.deaf else correction, weighing)
        return lambda sensed, now: self.after(step(*self.before(sensed, now)))


def _nothing(sensed: Sensed, command: Command | None, along: float) -> float:
    return 0.0


def late(sensed: Sensed, now: float) -> tuple[Sensed, float]:
    """Everything a tenth of a second late."""
    return replace(sensed, time=sensed.time - 0.1), now - 0.1


def slow(sensed: Sensed, now: float) -> tuple[Sensed, float]:
    sum(k * k for k in range(600_000))
    return sensed, now


def blind(sensed: Sensed, now: float) -> tuple[Sensed, float]:
    """The position is never looked at."""
    state = sensed.state.copy()
    state[:3] = controllers.wandering().state[controllers.wandering().row(now), :3]
    return replace(sensed, state=state), now


def nan(command: Command) -> Command:
    return replace(command, torque=(0.0, float("nan"), 0.0))


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (SpoiltController(late), controllers.check_follows, "off in the root"),
        (SpoiltController(after=nan), controllers.check_follows, "no number for torque"),
        (SpoiltController(blind), controllers.check_returns, "beside"),
        (SpoiltController(deaf=True), controllers.check_tells, "told of 0 samples"),
        (SpoiltController(deaf=True), controllers.check_uses, "with what is known"),
        (SpoiltController(light=True), controllers.check_carries, "by a factor"),
        (SpoiltController(slow), controllers.check_quick, "a command takes"),
    ],
)
def test_spoilt_controller(broken: Controller, check: Callable[[Controller], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken)


# ---------------------------------------------------------------- autopilots


@dataclass
class SpoiltAutopilot(Autopilot):
    """PX4's with something changed in what it returns or knows."""

    after: Callable[[Array], Array] = lambda forces: forces
    gyro: Callable[[Triple], Triple] = lambda rates: rates
    wide: bool = False

    def prepare(self, known: Known) -> Callable[[Command, float, Triple], Array]:
        if self.wide:
            known = replace(known, rig=known.rig.model_copy(update={"motor_force": (-5.0, 50.0)}))
        step = Px4().prepare(known)
        return lambda command, now, gyro: self.after(step(command, now, self.gyro(gyro)))


class Unloaded(Autopilot):
    """Begins with an empty integral."""

    def prepare(self, known: Known) -> Callable[[Command, float, Triple], Array]:
        reference = known.reference
        straight = reference.state.copy()
        straight[:, 7] = np.pi / 2
        return Px4().prepare(replace(known, reference=replace(reference, state=straight)))


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (SpoiltAutopilot(lambda forces: 0.9 * forces), autopilots.check_hovers, "N given"),
        (SpoiltAutopilot(gyro=lambda w: (-w[0], w[1], w[2])), autopilots.check_turns, "about axis 0"),
        (SpoiltAutopilot(wide=True), autopilots.check_limits, "N for"),
        (SpoiltAutopilot(lambda f: np.clip(3 * f - 10, 0, 8)), autopilots.check_hovers, "N given"),
        (Unloaded(), autopilots.check_preload, "hold the arm"),
    ],
)
def test_spoilt_autopilot(broken: Autopilot, check: Callable[[Autopilot], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken)


def test_autopilot_that_clips_each_motor() -> None:
    """The commonest mistake: yaw takes from roll what clipping leaves."""
    wide = SpoiltAutopilot(lambda forces: np.clip(forces, 0.0, 8.0), wide=True)
    with pytest.raises(AssertionError, match="roll torque"):
        autopilots.check_yaw_last(wide)


# ---------------------------------------------------------------- residuals


class Cheat(Residual):
    """Reads the truth that lies around in memory."""

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        return Cheating


class Cheating(Correction):
    """Of one flight."""

    def observe(self, sample: Sample) -> None:
        pass

    def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
        truths = [thing.state[:3] for thing in gc.get_objects() if isinstance(thing, Truth)]
        return np.tile(np.mean(truths or [np.zeros(3)], axis=0), (len(nodes), 1)), None


class Forgetful(Residual):
    """All flights share one correction."""

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        one = Filtered(0.1)
        return lambda: one


class Opposite(Residual):
    """Has the wrong sign."""

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        class Wrong(Correction):
            def __init__(self) -> None:
                self.right = Filtered(0.1)

            def observe(self, sample: Sample) -> None:
                self.right.observe(sample)

            def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
                return -self.right.predict(nodes, arm)[0], None

        return Wrong


class Steep(Residual):
    """Depends on the speed and does not say so."""

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        class Drag(Correction):
            def observe(self, sample: Sample) -> None:
                pass

            def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
                return -0.1 * nodes[:, 7:], None

        return Drag


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (Cheat(), residuals.check_only_samples, "more than the samples"),
        (Forgetful(), residuals.check_fresh, "the one before"),
        (Opposite(), residuals.check_flat, "off, predicting nothing"),
        (Steep(), residuals.check_gradient, "by number 7"),
    ],
)
def test_spoilt_residual(broken: Residual, check: Callable[[Residual], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken)


def test_the_unspoilt_observer_passes() -> None:
    for check in residuals.CHECKS:
        check(Observer())


# ---------------------------------------------------------------- payloads


@dataclass
class SpoiltPayload(Payload):
    """Weighs as told."""

    weigh: Weighing

    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        return self.weigh


@pytest.mark.parametrize(
    ("weigh", "check", "says"),
    [
        (lambda sensed, command, along: 0.075, payloads.check_empty, "though nothing is attached"),
        (lambda sensed, command, along: -0.1 if sensed.attached else 0.0, payloads.check_carried, "becomes"),
        (lambda sensed, command, along: 0.5 if sensed.attached else 0.0, payloads.check_carried, "weighs"),
        (lambda sensed, command, along: 0.075 * (sensed.time > 0), payloads.check_lost, "has dropped"),
    ],
)
def test_spoilt_payload(weigh: Weighing, check: Callable[[Payload], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(SpoiltPayload(weigh))


class Remembers(Payload):
    """Keeps the heaviest mass of all flights."""

    def __init__(self) -> None:
        self.most = 0.0

    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        def weigh(sensed: Sensed, command: Command | None, along: float) -> float:
            self.most = max(self.most, 0.05 if sensed.attached else 0.0)
            return self.most

        return weigh


def test_payload_that_remembers() -> None:
    with pytest.raises(AssertionError, match="a flight begins with"):
        payloads.check_fresh(Remembers())


# ---------------------------------------------------------------- predictors


@dataclass
class SpoiltPredictor(Predictor):
    """A line, of something else than what was seen."""

    before: Callable[[Seen], Seen] = lambda seen: seen
    window: float = 1.0

    def predict(self, seen: Seen) -> Motion | None:
        return ConstantVelocity(self.window).predict(self.before(seen))


def own_clock(seen: Seen) -> Seen:
    """Forgets that the last observation is older than the plan's beginning."""
    return replace(seen, time=seen.time - seen.time[-1])


def remembering() -> Callable[[Seen], Seen]:
    kept: list[Seen] = []

    def first(seen: Seen) -> Seen:
        kept.append(seen)
        return kept[-2] if len(kept) > 1 else seen

    return first


class Choosy(Predictor):
    """Knows the target once it has seen enough of it."""

    def predict(self, seen: Seen) -> Motion | None:
        return None if len(seen.time) > 50 else ConstantVelocity().predict(seen)


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (SpoiltPredictor(own_clock), predictors.check_line, "m off now"),
        (SpoiltPredictor(window=0.1), predictors.check_noise, "the target is"),
        (
            SpoiltPredictor(lambda s: replace(s, heading=0 * s.heading)),
            predictors.check_line,
            "a second later",
        ),
        (
            SpoiltPredictor(lambda s: replace(s, heading=0 * s.heading)),
            predictors.check_nowhere_special,
            "differently",
        ),
        (SpoiltPredictor(remembering()), predictors.check_fresh, "after others were seen"),
        (Choosy(), predictors.check_one_kind, "predicts it from others"),
    ],
)
def test_spoilt_predictor(broken: Predictor, check: Callable[[Predictor], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken)


def test_who_knows_the_target_passes() -> None:
    for check in predictors.CHECKS:
        check(Told())
