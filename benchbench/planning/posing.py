"""What a case can be posed as and started from, whatever its kind of scenario; strategies and guesses ask here."""

from __future__ import annotations

from collections.abc import Sequence

from benchbench.formulation import forms
from benchbench.formulation.problem import Problem
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning import starts
from benchbench.planning.case import Case
from benchbench.planning.starts import Made


def chosen(case: Case, names: Sequence[str], field: str) -> Made:
    """Return the stops of these names, None without any; raises BadInput where they are not what is asked for."""
    return case.scenario.itinerary.sequence(names, field) if names else None


def line(case: Case, made: Made = None) -> Plan:
    """Return the plain start: straight lines, at no cost."""
    return starts.line(case.scenario, case, made)


def point_mass(case: Case, ledger: Ledger) -> Plan:
    """Return the time-optimal flight of a point mass over the targets, or through the gates: one small solve."""
    return starts.point_mass(case.scenario, case, ledger)


def start(case: Case, ledger: Ledger, made: Made = None) -> Plan:
    """Return the cheapest start from which phases are solved: a straight line, or for a race a point mass."""
    return starts.start(case.scenario, case, ledger, made)


def phases(case: Case, plan: Plan) -> Problem:
    """Own step sizes before and after each contact or gate: smooth."""
    return forms.phases(case.scenario, case, plan)


def held(case: Case, plan: Plan) -> Problem:
    """One step size, contact or gates at the nodes nearest to the plan's: smooth."""
    return forms.held(case.scenario, case, plan)


def free(case: Case, plan: Plan) -> Problem:
    """One step size, progress variables and complementarity."""
    return forms.free(case.scenario, case, plan)
