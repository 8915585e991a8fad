"""What is proved about the task, and what a plan is asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench import Array, Evidence, Model, Plant, at_most
from benchbench.certificate.bound import lower_bound
from benchbench.certificate.certificate import Measures
from benchbench.certificate.check import Checks
from benchbench.certificate.checks import intervals, nodes, replay
from benchbench.certificate.difference import angle
from benchbench.certificate.evidence import Given
from benchbench.certificate.examination import Examination, examine
from benchbench.certificate.measured import measured
from benchbench.certificate.numbers import flown
from reach.scenario import AXES, Reach, off


@lower_bound.register
def _(scenario: Reach, model: Model, plant: Plant) -> float:
    """Return how long the way to the ball takes at full speed: on each axis (|p_end - p_start| - reach) / v_max."""
    place = [model.configuration.index(axis) for axis in AXES]
    way = np.abs(scenario.end_point(model) - scenario.start_point(model))[place] - scenario.reach
    return max(0.0, float(np.max(way / model.velocity.upper[place])))


@dataclass(frozen=True, kw_only=True, eq=False)
class ReachEvidence(Evidence):
    """What is measured besides: distances in m from the middle of the ball, at the nodes and on the replay."""

    scenario: Reach
    planned_off: Array
    flown_off: Array


@examine.register
def _(scenario: Reach, given: Given) -> Examination[ReachEvidence]:
    found = measured(scenario, given)
    planned, dense = (off(scenario, given.model, one.configuration) for one in (given.plan, found.flight))
    evidence = ReachEvidence(**vars(found), planned_off=planned, flown_off=dense)
    beyond = max(0.0, float(evidence.flown_off[-1]) - scenario.reach)
    return Examination(
        evidence,
        (
            nodes.planned_start, nodes.planned_limits, planned_reach, planned_rest, intervals.defect_position,
            intervals.defect_angle, intervals.defect_velocity, intervals.defect_rate,
        ),
        (replay.replay_position, replay.replay_angle, replay.replay_rate, flown_reach, flown_rest),
        Measures(**flown(evidence), replay_end_error_m=beyond),
    )  # fmt: skip


def planned_reach(evidence: ReachEvidence) -> Checks:
    """Check that the last node is in the ball, to numeric accuracy."""
    what, limit = "distance of the planned end from the middle of the ball", evidence.scenario.reach
    yield at_most("planned_reach", what, float(evidence.planned_off[-1]), limit + evidence.limits.node, "m")


def planned_rest(evidence: ReachEvidence) -> Checks:
    """Check that the last node is upright and at rest, to numeric accuracy."""
    plan, limit = evidence.plan, evidence.limits.node
    tilt = angle(plan, plan.configuration[-1:] - evidence.scenario.end_point(evidence.model))
    yield at_most("planned_upright", "planned angle from the end", float(tilt[0]), limit, "rad")
    fastest = float(np.max(np.abs(plan.velocity[-1])))
    yield at_most("planned_rest", "planned rate at the end", fastest, limit, "m/s or rad/s")


def flown_reach(evidence: ReachEvidence) -> Checks:
    """Check that what is flown ends in the ball."""
    what, limit = "distance of the replay's end from the middle of the ball", evidence.scenario.reach
    yield at_most("reach", what, float(evidence.flown_off[-1]), limit + evidence.limits.end_position, "m")


def flown_rest(evidence: ReachEvidence) -> Checks:
    """Check that what is flown ends at rest, by the share of the largest rates that the certificate grants."""
    fastest, granted = float(np.max(evidence.rates.ratio[-1])), evidence.limits.end_velocity_ratio
    yield at_most("rest", "rate at the end of the replay", fastest, granted, "times its limit")
