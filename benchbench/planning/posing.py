"""What the two kinds of scenario, handover and race, can be posed as; strategies and guesses ask here."""

from __future__ import annotations

from collections.abc import Sequence

from benchbench.formulation import handover, race
from benchbench.formulation.handover import Problem
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.stop import Stop
from benchbench.planning import guess, handover_start
from benchbench.planning.case import Case
from benchbench.planning.race_start import point_mass_plan

Made = Sequence[Stop] | None
"""Stops that are made, in order; None: as they are listed."""


def chosen(case: Case, names: Sequence[str], field: str) -> Made:
    """Return the stops of these names, None without any; raises BadInput where they are not what is asked for."""
    return case.scenario.itinerary.sequence(names, field) if names else None


def line(case: Case, made: Made = None) -> Plan:
    """Return the plain start: straight lines, at no cost."""
    if isinstance(case.scenario, Race):
        return race.straight_line(case.scenario, case)
    return guess.straight_line(case, made)


def point_mass(case: Case, ledger: Ledger) -> Plan:
    """Return the time-optimal flight of a point mass over the targets, or through the gates: one small solve."""
    if isinstance(case.scenario, Race):
        return point_mass_plan(case.scenario, case, ledger)
    return handover_start.point_mass_plan(case, ledger)


def start(case: Case, ledger: Ledger, made: Made = None) -> Plan:
    """Return the cheapest start from which phases are solved: a straight line, or for a race a point mass."""
    return point_mass(case, ledger) if isinstance(case.scenario, Race) else line(case, made)


def phases(case: Case, plan: Plan) -> Problem:
    """Own step sizes before and after each contact or gate: smooth."""
    if isinstance(case.scenario, Race):
        return race.phases(case.scenario, case, plan)
    return handover.phases(case, plan)


def held(case: Case, plan: Plan) -> Problem:
    """One step size, contact or gates at the nodes nearest to the plan's: smooth."""
    if isinstance(case.scenario, Race):
        return race.held(case.scenario, case, plan)
    return handover.nearest_held(case, plan)


def free(case: Case, plan: Plan) -> Problem:
    """One step size, progress variables and complementarity."""
    if isinstance(case.scenario, Race):
        return race.free(case.scenario, case, plan)
    return handover.free_contact(case, plan)
