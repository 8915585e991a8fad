"""Many flights of one plan: each with its own draw of the mismatch, judged one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from benchbench.analysis.binomial import decided
from benchbench.certificate.replay import Replay
from benchbench.flight.autopilot import Autopilot
from benchbench.flight.controller import Controller, Known
from benchbench.flight.course import Control, Course, Steady
from benchbench.flight.errand import errand
from benchbench.flight.foretold import foretold
from benchbench.flight.from_plan import reference_of
from benchbench.flight.judge import Verdict, judge
from benchbench.flight.limits import FlightLimits
from benchbench.flight.loop import Log, fly, unflown
from benchbench.flight.mismatch import Drawn, Mismatch
from benchbench.flight.payload import Payload
from benchbench.flight.predictor import Predictor
from benchbench.flight.pursuit import Pursuit, hovering
from benchbench.flight.reference import Reference
from benchbench.flight.replanning import Replanning
from benchbench.flight.residual import Correction, Recorder, Residual
from benchbench.flight.rig import Rig
from benchbench.flight.sensors import Sensors
from benchbench.flight.sight import Sight
from benchbench.flight.training import training_reference
from benchbench.flight.world import World
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.ocp.airframe import Airframe, FlownModel, airframe_of
from benchbench.ocp.motion import Motion
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case

PER_SEED = 1_000_000
"""Flights that one seed of a run has; another seed has others."""
FEWEST = 20
"""Flights before a search gives a plan up."""
TRAINING = 1
"""Noise of training flights is not that of the flight."""


@dataclass(frozen=True)
class Flown:
    """One flight: which, in what world, what happened, and the judgement.

    reference     what it followed from its beginning to its end
    learning_cpu  s of training flights; replan_cpu: s of each plan made in the loop, refused: how many of them were none
    """

    number: int
    mismatch: Drawn
    log: Log
    verdict: Verdict
    reference: Reference
    learning_cpu: float = 0.0
    replan_cpu: tuple[float, ...] = ()
    refused: int = 0


@dataclass(frozen=True)
class Chase:
    """A target that has to be predicted, its true motion, and what plans towards it."""

    replanning: Replanning
    target: Motion


@dataclass(frozen=True)
class Campaign:
    """Everything that decides how a plan is flown: one choice from every family, and how often."""

    count: int
    seed: int
    world: World
    controller: Controller
    autopilot: Autopilot
    residual: Residual
    payload: Payload
    predictor: Predictor
    mismatch: Mismatch
    rig: Rig
    limits: FlightLimits
    names: Mapping[str, str]
    target: float | None = None

    def check(self, scenario: object, model: object) -> None:
        """Raise BadInput, or IncompatibleCase, for what cannot be flown."""
        task = errand(scenario)
        if not isinstance(model, FlownModel):
            name = getattr(model, "name", type(model).__name__)
            problem = f"no world can be made of '{name}'"
            raise IncompatibleCase(
                "vehicle",
                problem,
                "a vehicle with an airframe, such as table1, table1_quaternion, table2; or flights=0",
            )
        _check_motors(self.rig, model.airframe)
        if task.reach < task.farthest:
            problem = f"{task.reach:g} m is less than the plan's contact may be away"
            raise BadInput("scenario.magnet_reach", problem, f"at least {task.farthest:g} m")
        if self.residual.training <= 0:
            self.residual.learn([])  # one that needs a flight to learn from says so
        foretold(self.predictor, self.names["predictor"], task.target)

    def fly(
        self, plan: Plan, replay: Replay, case: Case, hear: Callable[[int, int], None] | None = None
    ) -> tuple[Reference, list[Flown]]:
        """Fly a certified plan `count` times, with a target until it is decided whether that proves it.

        hear: told of each flight that begins, and of how many there are.
        """
        model, task = case.model, errand(case.scenario)
        reference, airframe = reference_of(plan, replay, model, task), airframe_of(model)
        predicted = foretold(self.predictor, self.names["predictor"], task.target)
        replanning = None if predicted is None else Replanning(case, predicted)
        flown = []
        for number in range(self.count):
            if hear:
                hear(number + 1, self.count)
            flown.append(
                self.once(reference, airframe, number, replanning and Chase(replanning, task.target))
            )
            if self.target is not None and self._decided(flown, self.target):
                break
        return reference, flown

    def _decided(self, flown: list[Flown], target: float) -> bool:
        """Whether more flights decide nothing; after `FEWEST`, since a rate is told of those that fail, too."""
        successes = sum(one.verdict.success for one in flown)
        return len(flown) >= FEWEST and decided(successes, len(flown), self.count, target)

    def once(
        self, reference: Reference, airframe: Airframe, number: int, chase: Chase | None = None
    ) -> Flown:
        """Fly a reference once, in the world of this number; chase: or a target that has to be predicted."""
        mismatch, spent = self.mismatch.draw(self.seed * PER_SEED + number), 0.0
        course: Steady | Pursuit
        try:
            correction, spent = self._learned(reference, airframe, mismatch)
            if chase is None:
                course = self._steady(reference, airframe, correction)
            else:
                course = self._pursuit(reference, airframe, mismatch, correction, chase)
        except Exception as error:  # noqa: BLE001  # residuals and controllers may be anybody's: it costs one flight
            log = unflown(f"preparing it raised {type(error).__name__}: {error}")
            return Flown(number, mismatch, log, judge(log, reference, airframe, self.limits), reference)
        log = self._run(course, airframe, mismatch, 0)
        followed, verdict = course.reference, judge(log, course.reference, airframe, self.limits)
        if isinstance(course, Steady):
            return Flown(number, mismatch, log, verdict, followed, spent)
        return Flown(number, mismatch, log, verdict, followed, spent, tuple(course.costs), course.refused)

    def _learned(self, reference: Reference, airframe: Airframe, mismatch: Drawn) -> tuple[Correction, float]:
        """A correction, after a training flight where it learns from one, and the CPU s of that."""
        if self.residual.training <= 0:
            return self.residual.learn([])(), 0.0
        recorder = Recorder()
        wander = training_reference(reference, airframe, self.residual.training, mismatch.seed)
        log = self._run(self._steady(wander, airframe, recorder), airframe, mismatch, TRAINING)
        return self.residual.learn([recorder.samples])(), log.cpu

    def _steady(self, reference: Reference, airframe: Airframe, correction: Correction) -> Steady:
        known = Known(reference, airframe, self.rig)
        weighing = self.payload.prepare(self.rig, airframe.total_mass)
        return Steady(reference, self.controller.prepare(known, correction, weighing))

    def _pursuit(
        self, reference: Reference, airframe: Airframe, mismatch: Drawn, correction: Correction, chase: Chase
    ) -> Pursuit:
        waiting = hovering(reference, chase.target, mismatch.target_late, airframe)
        weighing = self.payload.prepare(self.rig, airframe.total_mass)
        sight = Sight(chase.target, mismatch, float(waiting.time[0]), float(waiting.time[-1]))

        def prepare(now: Reference, before: Control | None) -> Control:
            return self.controller.prepare(Known(now, airframe, self.rig, before), correction, weighing)

        return Pursuit(chase.replanning, self.predictor, sight, waiting, airframe, prepare)

    def _run(self, course: Course, airframe: Airframe, mismatch: Drawn, salt: int) -> Log:
        reference = course.reference
        return fly(
            course,
            self.world.prepare(reference, airframe, self.rig, mismatch),
            self.autopilot.prepare(Known(reference, airframe, self.rig)),
            Sensors(mismatch, reference.window[0], salt),
        )


def _check_motors(rig: Rig, airframe: Airframe) -> None:
    """A world whose motors can do less than the plan asks leaves the controller nothing."""
    for field in ("motor_force", "servo_torque"):
        (low, high), planned = getattr(rig, field), getattr(airframe, field)
        if low > planned[0] or high < planned[1]:
            problem = f"[{low:g}, {high:g}] does not cover what the planner may use"
            raise BadInput(f"rig.{field}", problem, f"limits around [{planned[0]:g}, {planned[1]:g}]")
