"""The plan of a task made anew in the loop, and what of it is flown."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.replan import Replan, Replanner
from benchbench.storage.multirotor import MultirotorTrajectory, continuous, plan_of, trajectory_of

INTERVALS = 50
"""N of a plan in the loop: half of what is planned with before."""
MOST = {"accuracy": "low", "iteration_limit": 60, "time_limit": 5.0}
"""A plan that takes longer comes too late; 1e-4 of the KKT conditions, a tenth of a millimetre, is below what is known of a target."""


@dataclass(frozen=True)
class Way:
    """A plan from its own beginning on, every `STEP` s, as `Reference` has it; window in s from its beginning.

    q, v  (n, n_q) and (n, n_v) of the model, from which the next plan begins
    """

    replan: Replan
    q: Array
    v: Array
    state: Array
    inputs: Array
    acceleration: Array
    window: tuple[float, float]

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return STEP * (len(self.state) - 1)


@final
class Replanning:
    """Of one task: the program, built once, for all flights."""

    def __init__(self, case: Case, target: Motion) -> None:
        """Build and solve it for a target of the kind that will be predicted. Raises IncompatibleCase as `Replanner` does."""
        import scipy.interpolate  # noqa: F401  # two thirds of a second, which the first plan in a flight would be charged with

        scenario = case.scenario.model_copy(update={"target": target, "intervals": INTERVALS})
        self.planner = Replanner(replace(case, scenario=scenario, **MOST), rescue=False)  # type: ignore[arg-type]
        self.model = case.model
        self.start = (scenario.start_point(case.model), scenario.start_rates(case.model))

    def plan(self, target: Motion, last: Way | None, elapsed: float) -> Way | None:
        """Plan from where the last way is after `elapsed` s; from the scenario's start without one. None where none is found."""
        self.planner.last = self.planner.first if last is None else last.replan
        row = round(elapsed / STEP)
        q, v = self.start if last is None else (last.q[row], last.v[row])
        found = self.planner.plan(target, q, v, elapsed)
        outcome = found.result.solved.outcome
        return self._way(found) if outcome.claim == "solved" else None

    def _way(self, found: Replan) -> Way:
        plan = found.plan
        nodes = trajectory_of(plan)
        time: Array = STEP * np.arange(round(plan.travel_time / STEP) + 1, dtype=float)
        dense = between(nodes, time, plan.input_at(np.minimum(time, plan.travel_time)))
        own = plan_of(dense, self.model, "linear")
        arm = np.zeros((len(time), 3)) if dense.arm is None else dense.arm
        state = np.hstack(
            [dense.position, dense.quaternion, arm[:, :1], dense.velocity, dense.body_rates, arm[:, 1:2]]
        )
        q, v, u = own.configuration, own.velocity, own.inputs
        return Way(
            found, q, v, state, np.hstack([dense.thrusts, arm[:, 2:]]), self.model.plant().acceleration(q, v, u)[:, :3],
            _window(plan),
        )  # fmt: skip


def between(nodes: MultirotorTrajectory, time: Array, inputs: Array) -> MultirotorTrajectory:
    """Return a flight (n) at other times (m,) s: cubic Hermite through the nodes' places and speeds; inputs (m, 5) as they are."""
    from scipy.interpolate import CubicHermiteSpline

    w, x, y, z = nodes.quaternion.T
    a, b, c = nodes.body_rates.T / 2
    turning = np.stack(
        [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a], axis=-1
    )
    arm = np.zeros((len(nodes.time), 3)) if nodes.arm is None else nodes.arm
    places = np.hstack([nodes.position, nodes.quaternion, arm[:, :1]])
    speeds = np.hstack([nodes.velocity, turning, arm[:, 1:2]])
    at = np.minimum(time, nodes.time[-1])
    spline = CubicHermiteSpline(nodes.time, places, speeds)
    place, speed = spline(at), spline(at, 1)
    q = place[:, 3:7] / np.linalg.norm(place[:, 3:7], axis=1, keepdims=True)
    return MultirotorTrajectory(
        time=time, position=place[:, :3], quaternion=continuous(q), velocity=speed[:, :3], body_rates=_rates(q, speed[:, 3:7]),
        thrusts=inputs[:, :4], arm=np.stack([place[:, 7], speed[:, 7], inputs[:, 4]], axis=-1),
    )  # fmt: skip


def _rates(q: Array, change: Array) -> Array:
    """Body rates (n, 3) rad/s of quaternions (n, 4) that change so, 1/s."""
    w, x, y, z = q.T
    rows = np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])
    return np.asarray(2 * np.einsum("ijn,nj->ni", rows, change))


def _window(plan: Plan) -> tuple[float, float]:
    first, last = plan.contact() or (0, 0)
    return float(plan.time[first]), float(plan.time[last])
