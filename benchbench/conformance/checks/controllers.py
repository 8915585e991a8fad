"""What every controller must do: follow a way in time, come back to it, use what is known, and be quick."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import final

import numpy as np

from benchbench.conformance.checks.flying import Obedient, known, shifted, wandering
from benchbench.conformance.checks.require import require
from benchbench.flight.controller import PERIOD, Controller
from benchbench.flight.reference import Reference
from benchbench.flight.residual import Correction, Recorder, Sample
from benchbench.flight.sensed import Command, Sensed
from benchbench.ground.arrays import Array

PUSH = np.array([0.4, -0.3, 0.5])
"""m/s^2, which the model does not know."""


@final
class Told(Correction):
    """Knows the residual acceleration beforehand."""

    def observe(self, sample: Sample) -> None:
        """Nothing to learn."""

    def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
        """The same everywhere."""
        return np.tile(PUSH, (len(nodes), 1)), None


def check_follows(controller: Controller) -> None:
    """A body that obeys stays within 10 mm of the reference, a quarter of what 0.1 s of lateness costs."""
    errors, commands = _flown(controller, wandering(), Recorder())
    require(_rms(errors) < 0.01, f"it is {1e3 * _rms(errors):.3g} mm off in the root mean square")
    for name in ("thrust", "rates", "spin", "torque", "arm"):
        numbers = np.array([np.atleast_1d(getattr(command, name)) for command in commands])
        require(bool(np.isfinite(numbers).all()), f"commands no number for {name}")


def check_returns(controller: Controller) -> None:
    """From 10 cm beside, it is within 15 mm after 2 s."""
    errors, _ = _flown(controller, wandering(), Recorder(), np.array([0.08, -0.06, 0.0]))
    late = errors[round(2.0 / PERIOD) :]
    require(_rms(late) < 0.015, f"2 s after 10 cm beside it is still {1e3 * _rms(late):.3g} mm off")


def check_tells(controller: Controller) -> None:
    """It tells its correction of accelerations that it did not expect, as they are."""
    recorder = Recorder()
    _flown(controller, wandering(), recorder, push=PUSH)
    found = (
        np.mean([sample.acceleration for sample in recorder.samples[5:]], axis=0)
        if recorder.samples
        else np.zeros(3)
    )
    require(len(recorder.samples) > 50, f"it told of {len(recorder.samples)} samples in {_seconds():g} s")
    require(float(np.abs(found - PUSH).max()) < 0.1, f"it told of {found} m/s^2 on average, {PUSH} pushed")


def check_uses(controller: Controller) -> None:
    """What the correction predicts is used: the error is less than half of that without."""
    without, _ = _flown(controller, wandering(), Recorder(), push=PUSH)
    told, _ = _flown(controller, wandering(), Told(), push=PUSH)
    require(
        _rms(told) < 0.5 * _rms(without),
        f"{1e3 * _rms(told):.3g} mm off with what is known of the push, {1e3 * _rms(without):.3g} mm without",
    )


def check_carries(controller: Controller) -> None:
    """A known payload gets thrust in proportion to its mass."""
    _, empty = _flown(controller, wandering(), Recorder(), steps=1)
    _, loaded = _flown(controller, wandering(), Recorder(), steps=1, mass=0.2)
    total = known(wandering()).airframe.total_mass
    ratio = loaded[0].thrust / empty[0].thrust
    require(abs(ratio - 1 - 0.2 / total) < 0.01, f"0.2 kg more change the thrust by a factor {ratio:.4g}")


def check_quick(controller: Controller) -> None:
    """Half of the commands take less CPU time than until the next."""
    body, step = _begun(controller, wandering(), Recorder(), None, 0.0)
    costs = []
    for _ in range(30):
        before = time.thread_time()
        command = step(body.sensed(), body.time)
        costs.append(time.thread_time() - before)
        body.obey(command)
    require(float(np.median(costs)) < PERIOD, f"a command takes {1e3 * float(np.median(costs)):.3g} ms")


CHECKS = (check_follows, check_returns, check_tells, check_uses, check_carries, check_quick)


def _begun(
    controller: Controller, reference: Reference, correction: Correction, push: Array | None, mass: float
) -> tuple[Obedient, Callable[[Sensed, float], Command]]:
    def weighing(sensed: Sensed, command: Command | None, along: float) -> float:
        return mass

    return Obedient(reference, push), controller.prepare(known(reference), correction, weighing)


def _flown(
    controller: Controller, reference: Reference, correction: Correction, beside: Array | None = None,
    push: Array | None = None, steps: int | None = None, mass: float = 0.0,
) -> tuple[Array, list[Command]]:  # fmt: skip
    """Errors of position (m, 3) from the reference at each command, and the commands."""
    body, step = _begun(controller, reference, correction, push, mass)
    if beside is not None:
        body.state[:3] = shifted(reference, beside).state[0, :3]
    errors, commands = [], []
    for _ in range(steps or round(_seconds() / PERIOD)):
        command = step(body.sensed(), body.time)
        commands.append(command)
        body.obey(command)
        errors.append(body.state[:3] - reference.state[reference.row(body.time), :3])
    return np.array(errors), commands


def _seconds() -> float:
    reference = wandering()
    return float(reference.time[-1] - reference.time[0]) - 1.2


def _rms(errors: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(errors**2, axis=1))))
