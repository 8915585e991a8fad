"""A seeded disturbance of a plan that solves start from: another travel time, contact times, path and inputs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from benchbench.ground.arrays import Array
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case

TIME = 0.4
"""The travel time is multiplied by up to e^TIME either way."""
SHARE = 0.2
"""A contact moves by up to this share of the flight, and stays in order and within MIDDLE."""
MIDDLE = (0.1, 0.9)
PATH = 0.3
"""Amplitude in m and rad of the first of three sine waves added to each coordinate; the others are smaller."""
INPUTS = 0.2
"""Standard deviation of the inputs' noise, as a share of the room between their limits."""


def disturbed(plan: Plan, case: Case, seed: int) -> Plan:
    """Return another plan of the same nodes between the same ends; seed 0 gives the plan itself.

    Configurations and inputs stay within their limits. A coordinate without a unit (a quaternion) is left alone.
    """
    if seed == 0:
        return plan
    draw = np.random.default_rng(seed)
    total = np.clip(plan.travel_time * np.exp(draw.uniform(-TIME, TIME)), *case.scenario.travel_time)
    time = _moved(plan, draw) * total
    q = _bent(plan, case, draw)
    v = plan.velocity * plan.travel_time / total
    if plan.velocity_names == plan.coordinate_names:
        v = np.gradient(q, time, axis=0)
        v[[0, -1]] = plan.velocity[[0, -1]]
    v = np.clip(v, case.model.velocity.lower, case.model.velocity.upper)
    return replace(plan, time=time, configuration=q, velocity=v, inputs=_noisy(plan, case, draw))


def _moved(plan: Plan, draw: Generator) -> Array:
    """Shares of the travel time (N + 1,), the middle of each contact moved."""
    share = plan.time / plan.travel_time
    middles = [float(share[first] + share[last]) / 2 for first, last in plan.contacts]
    middles = [middle for middle in middles if 0.0 < middle < 1.0]
    wanted = np.array(middles) + draw.uniform(-SHARE, SHARE, len(middles))
    wanted = np.sort(np.clip(wanted, *MIDDLE)) + 1e-3 * np.arange(len(middles))
    return np.interp(share, [0.0, *middles, 1.0], [0.0, *wanted, 1.0])


def _bent(plan: Plan, case: Case, draw: Generator) -> Array:
    box = case.scenario.limits(case.model)
    waves = np.array([np.sin(j * np.pi * np.linspace(0.0, 1.0, len(plan.time))) for j in (1, 2, 3)])
    size = np.array([0.0 if unit == "1" else PATH for unit in plan.coordinate_units])
    amplitude = draw.uniform(-1.0, 1.0, (3, len(size))) / np.array([[1.0], [2.0], [3.0]]) * size
    bent = np.clip(plan.configuration + waves.T @ amplitude, box.lower, box.upper)
    bent[[0, -1]] = plan.configuration[[0, -1]]
    return np.asarray(bent)


def _noisy(plan: Plan, case: Case, draw: Generator) -> Array:
    low, high = case.model.inputs.lower, case.model.inputs.upper
    room = np.where(np.isfinite(high - low), high - low, 0.0)
    return np.asarray(np.clip(plan.inputs + draw.normal(size=plan.inputs.shape) * INPUTS * room, low, high))
