"""A case: one choice from every family; and the interfaces of the two families that see all of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from benchbench.certificate.bound import bounded
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify, certify_problem
from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.formulation.formulation import Formulation
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import PublishedProblem, ReadyMade
from benchbench.nlp.homotopy import Solved
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.method import Method
from benchbench.ocp.plan import Plan
from benchbench.planning.result import Result, Solution
from benchbench.storage.columns import columns


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
    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Return the best plan found; the last word on it is not the strategy's."""


class MpccStrategy(Strategy):
    """A strategy that needs no more than an MPCC, so that it solves those that come ready-made too."""

    @abstractmethod
    def solve_mpcc(self, mpcc: Mpcc, case: Method, ledger: Ledger) -> Solved:
        """Return the best solution found of an MPCC, from the guess it comes with."""


@dataclass(frozen=True, kw_only=True)
class AnyCase(Method, ABC):
    """What the pipeline asks of a case, be it a flight or an MPCC that comes ready-made."""

    strategy: Strategy
    limits: ProblemLimits
    task_hash: str | None = None
    """What a result may be compared with, see `benchbench.planning.task_hash`."""

    @abstractmethod
    def plan(self, ledger: Ledger) -> Result:
        """Plan; raises BadInput where the strategy cannot."""

    @abstractmethod
    def judge(self, result: Result) -> Certificate:
        """Certify what planning gave."""

    @abstractmethod
    def told(self, result: Result) -> Mapping[str, Any]:
        """Return the columns of the record that only this kind of case has."""


@final
@dataclass(frozen=True, kw_only=True)
class Case(AnyCase, Formulation):
    """Everything that decides the run of a flight: one choice from every family."""

    guess: Guess
    limits: Limits

    def plan(self, ledger: Ledger) -> Result:
        """Pose and solve as the strategy does."""
        return self.strategy.solve(self, ledger)

    def judge(self, result: Result) -> Certificate:
        """Certify the plan, and the solution where one of our problems was posed."""
        found = result.posed and result.posed.residuals
        return certify(result.plan, self.scenario, self.model, self.limits, found)

    def told(self, result: Result) -> Mapping[str, Any]:
        """Grid, times, and the task where the plan is ours, on the scenario's own grid or refined from it, so comparable."""
        plan, scenario = result.plan, self.scenario
        own = plan.intervals == scenario.grid_intervals or result.refined
        comparable = result.posed is not None and own
        return {
            "intervals": plan.intervals,
            **columns(scenario),
            "travel_time_s": plan.travel_time,
            **bounded(scenario, self.model, self.model.plant()),
            "task_hash": self.task_hash if comparable else None,
        }


@final
@dataclass(frozen=True, kw_only=True)
class ReadyCase(AnyCase):
    """Everything that decides the run of an MPCC that comes ready-made; there is no plan in its solution."""

    scenario: ReadyMade

    def plan(self, ledger: Ledger) -> Result:
        """Solve the MPCC; raises IncompatibleCase for a strategy that needs a flight."""
        with ledger.building():
            mpcc = self.scenario.mpcc()
        if not isinstance(self.strategy, MpccStrategy):
            able = "continuation, relax, or another one that needs nothing but an MPCC"
            problem = f"'{self.names['strategy']}' plans flights, but '{self.names['scenario']}' is none"
            raise IncompatibleCase("strategy", problem, able)
        return Result(posed=Solution(mpcc, self.strategy.solve_mpcc(mpcc, self, ledger)))

    def judge(self, result: Result) -> Certificate:
        """Certify the solution by its residuals, which are all there is to ask."""
        return certify_problem(result.solution.residuals, self.limits)

    def told(self, result: Result) -> Mapping[str, Any]:
        """Which problem it is, and its published optimum; what else a record says is of flights."""
        known = self.scenario.published if isinstance(self.scenario, PublishedProblem) else None
        told = {"published_objective": known.objective, "published_source": known.source} if known else {}
        return {"task_hash": self.task_hash, **told}
