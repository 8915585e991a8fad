"""Inputs that neighbours share at their nodes: what alternates from node to node adds up to nothing in rules that read them there."""

from __future__ import annotations

import numpy as np
import pytest

from benchbench.certificate.replay import replay
from benchbench.conformance.checks.initial_value import integrate, one_phase, told, transcribe
from benchbench.ocp.plan import Plan
from benchbench.transcription.dynamics import Dynamics
from benchbench_plugins.dynamics.hermite_simpson import HermiteSimpson
from benchbench_plugins.dynamics.trapezoidal import Trapezoidal
from benchbench_plugins.models.pendulum import Pendulum

RULES = [Trapezoidal, HermiteSimpson]


def flown(rule: Dynamics, loud: bool) -> Plan:
    """A pendulum with no torque, or with one of changing sign, as the rule has it."""
    ours = transcribe(rule, Pendulum(), one_phase(20, 1.0))
    torque = told(
        ours, np.array([0.5]), np.zeros(1),
        lambda t: 2.0 * loud * (-1.0) ** np.arange(len(t))[:, None],
    )  # fmt: skip
    return integrate(ours, torque)


@pytest.mark.parametrize("rule", RULES)
def test_linear_inputs_hide_an_alternating_one_from_the_nodes(rule: type[Dynamics]) -> None:
    """The plan's speeds hardly know of it (its weight, at a place that swings), the pendulum swings between the nodes; held inputs are seen."""
    quiet, loud = flown(rule(inputs="linear"), False), flown(rule(inputs="linear"), True)
    seen = np.abs(loud.velocity - quiet.velocity).max()
    between = replay(loud, Pendulum().plant(), restart_nodes=range(1, 20)).velocity
    calm = replay(quiet, Pendulum().plant(), restart_nodes=range(1, 20)).velocity
    assert np.abs(between - calm).max() > 10 * seen
    held = np.abs(flown(rule(), True).velocity - flown(rule(), False).velocity).max()
    assert held > 10 * seen


@pytest.mark.parametrize("rule", RULES)
def test_inputs_are_held_unless_told_otherwise(rule: type[Dynamics]) -> None:
    assert flown(rule(), True).interpolation == "hold"
