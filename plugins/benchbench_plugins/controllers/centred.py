"""How far from the ball a plan is followed, so that the ball is taken inside what is allowed and not at its edge.

A ball that is taken before the plan itself comes within the magnet's reach is taken too soon. A vehicle that is nearer than the plan
there has only the way that the magnet needs to pull; one that is farther has all that the plan goes deeper into the reach, as long as
the window lasts.
"""

from __future__ import annotations

import numpy as np

from benchbench.flight.reference import Reference, entry, tip
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe

PULL = 0.04
"""s from where a ball comes within reach until it hangs at the magnet (a guess, whatever the rig)."""
SOON = 0.25
"""Share of the time from the plan's reach to the window's end in which the ball is to hang there: errors across the way only delay it."""
SLOWLY = 0.5
"""s in which the vehicle is led aside before the reach, and back after the planned contact began."""


def aside(reference: Reference, airframe: Airframe, share: float) -> tuple[Array, Array]:
    """Places (n, 3) m and speeds (n, 3) m/s to be added to a reference: away from the ball, by a share of the room there is.

    No farther than the plan has come at `SOON`; zero where it never comes within reach, or goes no deeper than the magnet pulls meanwhile.
    """
    arm = (airframe.arm_offset, airframe.arm_length)
    begin, (first, last) = entry(reference, *arm), reference.window
    none = np.zeros((len(reference.time), 3))
    if not begin <= last:
        return none, none
    place, way = tip(reference.state, *arm)
    away = place - reference.target[:, :3] + [0, 0, reference.ball_radius]
    clear = np.linalg.norm(away, axis=1) - reference.ball_radius
    row, held = reference.row(begin), slice(reference.row(first), reference.row(last) + 1)
    pulled = PULL * float(np.linalg.norm(way[row] - reference.target[row, 3:]))
    soon = reference.row(begin + max(SOON * (last - begin) - PULL, 0.0))
    room = share * (reference.reach - float(clear[held].min()) - pulled)
    far = max(min(room, reference.reach - float(clear[soon])), 0.0)
    before, after = (
        (reference.time - begin + SLOWLY) / SLOWLY,
        (max(first, begin) + SLOWLY - reference.time) / SLOWLY,
    )
    part, sign = np.minimum(before, after).clip(0.0, 1.0), np.where(before < after, 1.0, -1.0)
    led = far * away[row] / np.linalg.norm(away[row])
    return np.outer(part**2 * (3 - 2 * part), led), np.outer(sign * 6 * part * (1 - part) / SLOWLY, led)
