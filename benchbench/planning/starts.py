"""What a solve can start from at little cost; each kind of scenario answers in its own way, see `formulation.forms`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch

from benchbench.formulation import race
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.stop import Stop
from benchbench.planning import guess, handover_start, race_start
from benchbench.planning.case import Case

Made = Sequence[Stop] | None
"""Stops that are made, in order; None: as they are listed."""


@singledispatch
def line(scenario: Scenario, case: Case, made: Made = None) -> Plan:
    """Return the plain start: straight lines over the targets, at no cost."""
    return guess.straight_line(case, made)


@singledispatch
def point_mass(scenario: Scenario, case: Case, ledger: Ledger) -> Plan:
    """Return the time-optimal flight of a point mass over the targets: one small solve."""
    return handover_start.point_mass_plan(case, ledger)


@singledispatch
def start(scenario: Scenario, case: Case, ledger: Ledger, made: Made = None) -> Plan:
    """Return the cheapest start from which phases are solved: the plain one, if nothing else is needed."""
    return line(scenario, case, made)


@line.register
def _(scenario: Race, case: Case, made: Made = None) -> Plan:
    return race.straight_line(scenario, case)


point_mass.register(Race, race_start.point_mass_plan)


@start.register
def _(scenario: Race, case: Case, ledger: Ledger, made: Made = None) -> Plan:
    return point_mass(scenario, case, ledger)
