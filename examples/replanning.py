"""The target turns while the vehicle approaches, and the plan follows: `python examples/replanning.py`.

Every 50 ms the plan is made again from where the vehicle is by then (here: exactly where the last plan said) for a
target that moves on with its present velocity. At 0.4 s and 0.7 s that velocity changes.
"""

from __future__ import annotations

from statistics import median

import numpy as np

from benchbench import Plan
from benchbench.planning.replan import Replanner
from benchbench.run import config
from benchbench_plugins.motions import Linear

PERIOD = 0.05  # s
TURNS = {
    8: (0.12, 0.02, 0.0),
    14: (0.08, -0.01, 0.0),
}  # new velocity of the target in m/s, by number of the plan


def main(intervals: int = 100) -> None:
    """Replan until contact is near; print how long each plan took and what the certificate says of it."""
    case = config.compose(
        "+scenario=linear", f"scenario.intervals={intervals}", "scenario.contact_seconds=0.03"
    )
    replanner = Replanner(case)
    start, velocity = np.array(case.scenario.target.start_m), np.array(case.scenario.target.velocity_mps)
    answer, seconds, number = replanner.first, [], 0
    print(f"first plan: {answer.seconds * 1e3:.0f} ms, travel time {answer.plan.travel_time:.4f} s")
    while contact(answer.plan) > 3 * PERIOD:
        number += 1
        start = start + PERIOD * velocity
        velocity = np.array(TURNS.get(number, velocity))
        q, v = at(answer.plan, PERIOD)
        answer = replanner.plan(Linear(tuple(start), tuple(velocity)), q, v, PERIOD)
        seconds.append(answer.seconds)
        certificate = answer.certificate()
        verdict = "certified" if certificate.certified else f"NOT certified: {certificate.reasons[0]}"
        turned = "  the target turns" if number in TURNS else ""
        print(
            f"{number * PERIOD:.2f} s: {answer.seconds * 1e3:4.0f} ms, {answer.result.solved.outcome.iterations:3d} "
            f"iterations, contact in {contact(answer.plan):.3f} s, end in {answer.plan.travel_time:.4f} s, {verdict}{turned}"
        )
    print(f"median {median(seconds) * 1e3:.0f} ms, longest {max(seconds) * 1e3:.0f} ms per plan")


def contact(plan: Plan) -> float:
    """When contact begins, s."""
    return float(plan.time[np.argmax(plan.progress > 0)])


def at(plan: Plan, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Configuration and velocity of a plan at a time in s, linear between nodes."""
    q, v = (
        np.array([np.interp(time, plan.time, c) for c in a.T]) for a in (plan.configuration, plan.velocity)
    )
    return q, v


if __name__ == "__main__":
    main()
