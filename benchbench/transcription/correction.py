"""Deferred correction: the equations of motion with the error of the transcription on their right-hand side.

What a transcription of low order does wrong in an interval hardly depends on small changes of the plan. What its equations leave
where the interval is flown as it really goes is that error; with it on the right-hand side they have the flown motion as their
solution, on the same grid. Repeated from each plan to the next, the error goes to zero as a Newton method with an approximate
Jacobian does (Stetter 1978, The defect correction principle and discretization methods, doi:10.1007/BF01432879).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, evaluated
from benchbench.transcription.grid import Trajectory
from benchbench.transcription.nodal import NodalTrajectory
from benchbench.transcription.runge_kutta import INCREMENTS, StageTrajectory


def correctable(trajectory: Trajectory) -> bool:
    """Tell whether the equations of motion read no states but those at nodes; with stages in between there is more to be right."""
    return bool(_equations(trajectory))


def _equations(trajectory: Trajectory) -> tuple[str, ...]:
    return trajectory.equations if isinstance(trajectory, NodalTrajectory | StageTrajectory) else ()


def corrected(
    mpcc: Mpcc, trajectory: Trajectory, values: Mapping[str, Array], ends: Mapping[str, Array]
) -> Mpcc:
    """Return the problem whose equations of motion hold where each interval ends as it is flown.

    values: a plan, as the unknowns by name; ends: where each interval, flown from its planned first state, ends, by the
    name of the unknown: q (N, n_q) and v (N, n_v).
    """
    names = _equations(trajectory)
    if isinstance(trajectory, StageTrajectory):
        values = {**values, INCREMENTS: trajectory.increments(lambda block: _flown(block, values, ends))}
    return replace(
        mpcc, constraints=tuple(_shifted(b, values, ends) if b.name in names else b for b in mpcc.constraints)
    )


def _shifted(block: Block, values: Mapping[str, Array], ends: Mapping[str, Array]) -> Block:
    """The same equations with what they leave of the flown intervals on their right-hand side."""
    shift = evaluated(block, np.hstack(_flown(block, values, ends)))
    return replace(block, lower=shift, upper=shift)


def _flown(block: Block, values: Mapping[str, Array], ends: Mapping[str, Array]) -> list[Array]:
    """What a block reads, slot by slot, where each interval ends as it is flown."""
    reads = []
    for slot in block.slots:
        rows = values[slot.variable]
        right = slot.variable in ends and slot.index[0, 0] // rows.shape[1] == 1  # of the first interval
        reads.append(ends[slot.variable] if right else rows.ravel()[slot.index])
    return reads
