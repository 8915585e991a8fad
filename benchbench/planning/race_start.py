"""A start for races: the time-optimal flight of a point mass through the gates, one free duration per segment."""

from __future__ import annotations

import numpy as np

from benchbench.formulation.gates import StatePlace, at_nodes
from benchbench.formulation.race import segments
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.planning.case import Case
from benchbench.planning.point_mass import INTERVALS, fly


def point_mass_plan(race: Race, case: Case, ledger: Ledger) -> Plan:
    """Return the vehicle's guess of how to follow the point mass, at the nodes of the point mass."""
    grid = segments(race, INTERVALS, race.segments / race.speed_guess)
    corners = np.array([race.start_position, *(goal.position for goal in race.goals)])
    at_gates = Mpcc((), at_nodes(race, StatePlace("p", 3, 3), grid.ends, race.goals))
    passed = np.zeros(grid.intervals + 1)
    passed[list(grid.ends)] = 1.0
    return fly(case, ledger, grid, corners, at_gates, passed)
