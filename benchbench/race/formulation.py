"""From a race to the problem of phases: one step size per segment, gates at the nodes between them; smooth."""

from __future__ import annotations

import casadi as ca
import numpy as np

from benchbench.case import Case
from benchbench.formulation import Problem
from benchbench.mpcc import Mpcc
from benchbench.plan import Plan
from benchbench.race.point_mass import gates, segments
from benchbench.race.scenario import Race


def phases(race: Race, case: Case, start: Plan) -> Problem:
    """Each gate is passed at the last node of its segment; guessed from a plan that claims gates at nodes."""
    passed = [0.0, *start.time[start.progress > 0.5]]
    grid = segments(race, race.nodes_per_gate, np.diff(passed))
    base, trajectory = case.dynamics.transcribe(race, case.model, grid)
    names = case.model.configuration.names
    at_gates = gates(race, grid, ca.SX.sym("p", 3), "q", len(names))
    mpcc = base.start_from(trajectory.encode(start)) + Mpcc((), (at_gates,))
    return Problem(mpcc, trajectory, race.gate_nodes())
