"""A case: one choice from every family; and the interfaces of the two families that see all of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.errors import IncompatibleCase
from benchbench.formulation.formulation import Formulation
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import ReadyMade
from benchbench.nlp.homotopy import Solved
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.method import Method
from benchbench.ocp.plan import Plan
from benchbench.planning.result import Outside, Result


class Guess(ABC):
    """Gives a plan to start from; it may be dynamically impossible, but makes progress at every stop.

    Where the progress is whole it claims a contact, which phases and windows need.
    """

    @abstractmethod
    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Return a plan on any grid."""


class Strategy(ABC):
    """Turns a case into a plan."""

    @abstractmethod
    def solve(self, case: Case, ledger: Ledger) -> Result | Outside:
        """Return the best plan found; the last word on it is not the strategy's."""

    def answer(self, mpcc: Mpcc, case: Task, ledger: Ledger) -> Solved:
        """Return the best solution of an MPCC that is no flight; only strategies override it that need no more."""
        able = "continuation, relax, or another one that needs nothing but an MPCC"
        problem = f"'{case.names['strategy']}' plans flights, but '{case.names['scenario']}' is none"
        raise IncompatibleCase("strategy", problem, able)


@dataclass(frozen=True, kw_only=True)
class Task(Method):
    """How an MPCC is solved and judged."""

    strategy: Strategy
    limits: ProblemLimits


@dataclass(frozen=True, kw_only=True)
class Case(Task, Formulation):
    """Everything that decides the run of a flight: one choice from every family.

    `task_hash` tells what its travel time may be compared with, see `benchbench.planning.task_hash`.
    """

    guess: Guess
    limits: Limits
    task_hash: str | None = None


@dataclass(frozen=True, kw_only=True)
class ReadyCase(Task):
    """Everything that decides the run of an MPCC that comes ready-made."""

    scenario: ReadyMade
