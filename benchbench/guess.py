"""Interface of an initial guess, and the simplest one."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from benchbench.case import Case, Ledger
from benchbench.motion import sample
from benchbench.plan import Plan

ABOVE = 0.02
"""How far above the target the straight line passes, m: a guess exactly on it sits on a stationary point."""


class Guess(ABC):
    """Gives a plan to start from; it may be dynamically impossible, but it must claim a contact."""

    @abstractmethod
    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Return a plan on any grid."""


def straight_line(case: Case) -> Plan:
    """Start, above the target at the guessed contact time, end; at hover, without turning anything but the nose."""
    scenario, model = case.scenario, case.model
    total, n = scenario.travel_time_guess, scenario.intervals
    contact = scenario.contact_guess * total
    start, end = scenario.start_point(model), scenario.end_point(model)
    (target,), (way,) = sample(scenario.target, np.array([contact]))
    over = start.copy()
    names = model.configuration.names
    xyz = [names.index(k) for k in ("x", "y", "z")]
    hang = model.plant().tool(start, np.zeros_like(start))[0] - start[xyz]
    over[xyz] = target - hang + [0.0, 0.0, ABOVE]
    if "yaw" in names and np.hypot(*way[:2]) > 0.0:
        over[names.index("yaw")] = np.arctan2(way[1], way[0])
    time = np.linspace(0.0, total, n + 1)
    corners = np.stack([start, over, end])
    q = np.stack([np.interp(time, [0.0, contact, total], column) for column in corners.T], axis=-1)
    first = min(int(scenario.contact_guess * n), n - scenario.kappa_init)
    progress = np.zeros(n + 1)
    progress[first : first + scenario.kappa_init] = 1.0
    c, w, u = model.configuration, model.velocity, model.inputs
    moving = np.gradient(q, time, axis=0) if c.names == w.names else np.zeros((n + 1, len(w.names)))
    return Plan(
        time, q, moving, np.tile(model.hover(), (n, 1)), progress, "hold",
        c.names, c.units, u.names, u.units, w.names, w.units,
    )  # fmt: skip
