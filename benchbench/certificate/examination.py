"""What is asked of a plan for each kind of scenario: an open list of kinds, each with its evidence and its checks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import singledispatch
from typing import Generic, TypeVar

from benchbench.certificate.certificate import Measures
from benchbench.certificate.check import Checks
from benchbench.certificate.evidence import Evidence, Given
from benchbench.ground.errors import IncompatibleCase
from benchbench.ocp.scenario import Scenario

E = TypeVar("E", bound=Evidence)


@dataclass(frozen=True, eq=False)
class Examination(Generic[E]):
    """The evidence of one plan, and what is asked of it, in order.

    planned   checks that every plan with finite numbers must pass
    flown     checks that need a replay without a breakdown, which is a broken limit by itself
    measures  numbers of the record
    """

    evidence: E
    planned: tuple[Callable[[E], Checks], ...]
    flown: tuple[Callable[[E], Checks], ...]
    measures: Measures


@singledispatch
def examine(scenario: Scenario, given: Given) -> Examination:
    """Return what is asked of a plan with finite numbers; each kind of scenario registers how.

    `@examine.register` on a function whose first parameter has the class of the scenario.
    Raises IncompatibleCase for a kind that did not register.
    """
    problem = f"nothing says how a {type(scenario).__name__} is certified"
    raise IncompatibleCase(
        "scenario", problem, "a kind that registers with benchbench.certificate.examination"
    )
