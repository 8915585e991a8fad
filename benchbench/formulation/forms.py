"""The three forms in which a scenario is posed as an MPCC; each kind of scenario answers in its own way.

`FORM.register(Kind, function)` gives a kind its own answer. What is here answers for kinds with nothing but stops on the
way, or with nothing at all between start and end.
"""

from __future__ import annotations

from functools import singledispatch

from benchbench.formulation import handover, race
from benchbench.formulation.formulation import Formulation
from benchbench.formulation.problem import Problem
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario


@singledispatch
def phases(scenario: Scenario, case: Formulation, start: Plan) -> Problem:
    """Own step sizes before and after each contact or gate: smooth. Raises IncompatibleCase."""
    return handover.phases(case, start)


@singledispatch
def held(scenario: Scenario, case: Formulation, start: Plan) -> Problem:
    """One step size, contacts or gates at the nodes nearest to the plan's: smooth."""
    return handover.nearest_held(case, start)


@singledispatch
def free(scenario: Scenario, case: Formulation, start: Plan) -> Problem:
    """One step size, progress variables and complementarity."""
    return handover.free_contact(case, start)


phases.register(Race, race.phases)
held.register(Race, race.held)
free.register(Race, race.free)
