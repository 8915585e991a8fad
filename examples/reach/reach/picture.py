"""What is drawn: the ball, and how far the vehicle is from its middle over time; in pictures, reports and recordings."""

from __future__ import annotations

import numpy as np

from benchbench import Model, Plan
from benchbench.certificate.replay import Replay
from benchbench.report.panel import Curve, Panel
from benchbench.report.panels import conditions
from benchbench.report.scene import Marks, marks
from reach.scenario import AXES, Reach, off


@marks.register
def _(scenario: Reach, plan: Plan) -> Marks:
    """Return three great circles of the ball, parted by NaN."""
    turn = np.linspace(0.0, 2 * np.pi, 49)
    circle = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1)
    circles = [np.vstack([np.roll(circle, k, axis=1), np.full(3, np.nan)]) for k in range(3)]
    middle = np.array([scenario.end.get(axis, 0.0) for axis in AXES])
    return Marks("ball", {f"{scenario.reach:g} m": middle + scenario.reach * np.concatenate(circles)})


@conditions.register
def _(scenario: Reach, plan: Plan, model: Model, replay: Replay | None) -> list[Panel]:
    flown = plan if replay is None else replay
    dots, line = ((one.time, off(scenario, model, one.configuration)) for one in (plan, flown))
    limit = Curve("distance", dots, line, -np.inf, scenario.reach)
    return [Panel("Distance to the end", "m", (limit,))]
