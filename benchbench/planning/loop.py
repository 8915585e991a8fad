"""The loop from the certificate back to the planner: solve, fly, do what the findings ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import isclose
from typing import Any, Literal

from benchbench.certificate.certificate import Certificate
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.findings import CHEAP, EQUAL, Round, Step, next_step
from benchbench.planning.ladder import climb, coarse, higher, on_grid, rung
from benchbench.planning.margins import Margins, least_margins, of_the_search, with_margins
from benchbench.planning.mesh import apart, exceeded, halved, marked, steady, touching
from benchbench.planning.prices import of_paths, of_rates
from benchbench.planning.rescue import rescue
from benchbench.planning.resting import once_they_rest
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge
from benchbench.storage.status import Status
from benchbench.transcription.correction import correctable

ROUNDS = 10
"""Solves that may follow the first one from a start."""
QUATERNION = "planned_quaternion"
"""Name of the check of their length."""
SAME = 1e-6
"""Share by which objectives of the same plan from two starts differ at most."""

Refinement = Literal["local", "uniform"]
Again = Callable[[Case, Ledger, Result, bool], Result]
"""Solves a case from a result of nearly the same; the last says whether to take the error of the transcription off."""


def phases_again(case: Case, ledger: Ledger, near: Result, correct: bool) -> Result:
    """Solve phases from the plan and the multipliers of a result."""
    return rung(case, ledger, near.plan, near, correct)


@dataclass
class Loop:
    """Rounds from any number of starts, with margins of at most `margin`; grids below `finest` intervals may be refined.

    margin      0: those of the scenario instead of measured ones; else measured on top of those it keeps
    refinement  where a grid is refined: in the intervals in which the replay found errors, or everywhere
    correction  whether the error of the transcription is taken off its equations where that can be
    again       how each round solves
    told        what each round gave, in words
    tried       each result, with its certificate where it claims success
    conflict    what stands in the way, where looks for a flight with slack found that something does
    firsts      objective of the first plan from each start
    unfinished  where the rounds of a start were used up
    slack       the least slack that they ended with, where a single one said so
    """

    case: Case
    ledger: Ledger
    finest: int
    margin: float
    refinement: Refinement = "local"
    correction: bool = True
    again: Again = phases_again
    told: list[str] = field(default_factory=list)
    tried: list[tuple[Result, Certificate | None]] = field(default_factory=list)
    conflict: str = ""
    slack: list[float] = field(default_factory=list)
    firsts: list[float] = field(default_factory=list)
    unfinished: tuple[Case, Result, Round] | None = None

    @property
    def best(self) -> Result:
        """The first certified result, else the one that breaks the fewest limits, else the last that was tried."""
        best, _ = min(self.tried, key=lambda one: (not one[0].claimed, _broken(one[1])))
        return replace(best, refined=True)

    @property
    def account(self) -> dict[str, Any]:
        """Columns that say what stands in the way, in place of what a plan that keeps nothing breaks."""
        if not self.conflict:
            return {"conflict": ""}
        return {
            "conflict": self.conflict, "reasons": (self.conflict,), "status": Status.INFEASIBLE,
            "advice": "ease one of the demands that are named, or try strategy=multistart, which looks elsewhere",
        }  # fmt: skip

    def certifies(self, case: Case, start: Plan) -> bool:
        """Plan from one start until the certificate accepts; returns whether it does."""
        least = least_margins(case.scenario, self.margin)
        level, found = self._first(with_margins(case, least), start)
        if found.claimed and any(isclose(found.objective, one, rel_tol=SAME) for one in self.firsts):
            self.told.append(f"{_seconds(found)}, as from an earlier start")
            return self._resumes()
        self.firsts.append(found.objective)
        return self.settles(level, found, least)

    def _resumes(self) -> bool:
        """Go on with as many rounds again where an earlier start had no more of them; returns whether that ends certified."""
        unfinished, self.unfinished = self.unfinished, None
        return unfinished is not None and self._rounds(*unfinished)

    def settles(self, level: Case, found: Result, least: Margins, cheap: Mapping[str, float] = CHEAP) -> bool:
        """Go on from a result that was made with the least margins until the certificate accepts; returns whether it does."""
        return self._rounds(level, found, Round(least, least, self.margin, cheap=cheap))

    def _rounds(self, level: Case, found: Result, now: Round) -> bool:
        for left in reversed(range(ROUNDS + 1)):
            certificate = judge(found, self.case, self.ledger) if found.claimed else None
            self.tried.append((found, certificate))
            self.told.append(_sentence(found, certificate, now))
            if certificate is None or certificate.certified or self.ledger.over:
                break
            if not left:
                self.unfinished = (level, found, now)
                break
            able = self.correction and correctable(found.problem.trajectory) and not _bent(certificate)
            now = replace(now, may_refine=found.plan.intervals < self.finest, correctable=able)
            prices = of_rates(found, level.model.velocity)
            now = replace(now, prices=prices, paths=of_paths(found, level.scenario))
            alone = apart(found.plan, certificate, level) if able else certificate
            step = next_step(certificate, level, now, alone)
            if step is None:
                break
            finer = self._finer(level, found, certificate, alone, step, now) if step.finer else level
            raised = now.raised + 1 if finer is level else 0
            before = now.margins
            now = replace(now, margins=step.margins, raised=raised, corrected=step.correct)
            level, last = with_margins(finer, step.margins), found
            found = self.again(level, self.ledger, last, step.correct)
            if not found.claimed and before != step.margins and not self.ledger.over:
                self.told.append(_sentence(found, None, now))
                level, now = with_margins(finer, before), replace(now, margins=before)
                found = self.again(level, self.ledger, last, step.correct)
        return certificate is not None and certificate.certified

    def _first(self, case: Case, start: Plan) -> tuple[Case, Result]:
        """The plan on the case's own grid, by way of a coarse one; where that fails, from a flight that was found with slack.

        Without such a flight, and with a conflict in its place, what failed. Also the case, which may wait for targets to stand.
        """
        (case, below), *others = self._sides(case, start)
        first = coarse(case)
        if below.claimed or self.ledger.over:
            done = first is case or not below.claimed
            return (case, below) if done else self._onward(case, below, *others)
        saved = rescue(first, self.ledger, (start, below.plan), self.slack)
        self.conflict, self.slack = saved.conflict, [*self.slack, *saved.slack]
        if saved.plan is not None:
            return case, climb(case, self.ledger, saved.plan)
        if saved.conflict or saved.slack or first is case or self.ledger.over:
            return case, below
        return case, rung(case, self.ledger, start)

    def _onward(self, case: Case, below: Result, *others: tuple[Case, Result]) -> tuple[Case, Result]:
        """The plan on the case's own grid; that of another side, where the coarse grid promised more than came of the better one."""
        found = higher(case, self.ledger, below)
        for other, coarser in others:
            if coarser.claimed and not self.ledger.over and not found.objective <= coarser.objective:
                again = higher(other, self.ledger, coarser)
                if again.claimed and not (found.claimed and found.objective <= again.objective):
                    self.told.append(
                        f"{_seconds(found)}, with contact on the other side of its target's stop {_seconds(again)}"
                    )
                    case, found = other, again
        return case, found

    def _sides(self, case: Case, start: Plan) -> list[tuple[Case, Result]]:
        """Results on the coarse grid, the better first: contact at any time, and once the targets stand that come to rest."""
        other = once_they_rest(case)
        if other is None:
            return [(case, rung(coarse(case), self.ledger, start))]
        waits = rung(coarse(other), self.ledger, start)
        now = rung(coarse(case), self.ledger, start)
        if not waits.claimed or now.objective < waits.objective:
            return [(case, now), (other, waits)]
        told = f"{now.plan.travel_time:.4f} s" if now.claimed else str(now.solved.outcome.claim)
        self.told.append(f"{_seconds(waits)} with contact once its target stands, at any time: {told}")
        return [(other, waits), (case, now)]

    def _finer(
        self, level: Case, found: Result, certificate: Certificate, alone: Certificate, step: Step, now: Round
    ) -> Case:
        """The case on the next grid; the same one where no interval has to be cut."""
        chosen = exceeded(found, alone, level, step, now.corrected) if step.correct else None
        if chosen is not None and not chosen.any() and (not now.corrected or step.margins != now.margins):
            return level
        if chosen is None or not chosen.any():
            chosen = marked(found.plan, certificate, level)
            chosen = chosen | touching(found.plan) if step.contacts else chosen
        if self.refinement == "local" and steady(level):
            return replace(level, mesh=halved(found.problem.trajectory.grid, chosen))
        return on_grid(level, 2 * level.scenario.grid_intervals)


def settled(
    case: Case, ledger: Ledger, found: Result, finer: int, margin: float, least: Margins, again: Again
) -> Result:
    """Go on from a result of a strategy that keeps its own form on grids of equal steps, as `Loop` does.

    found: made with the least margins. Without a margin nothing is measured, and the result is as it is; so it is where the certificate
    accepts nothing later either.
    """
    if not margin or not found.claimed or judge(found, case, ledger).certified:
        return found
    finest = finer * case.scenario.grid_intervals
    loop = Loop(case, ledger, finest, margin, "uniform", again=again)
    good = loop.settles(with_margins(case, least), found, least, EQUAL)
    return of_the_search(found, loop.best if good else found).telling(refinement=loop.told)


def _seconds(found: Result) -> str:
    at = f"N = {found.plan.intervals}"
    return f"{at}: {found.plan.travel_time:.4f} s" if found.claimed else f"{at}: {found.solved.outcome.claim}"


def _bent(certificate: Certificate) -> bool:
    """Whether a correction has changed the length of quaternions, which the equations of a transcription keep: a finer grid does not."""
    return any(check.name == QUATERNION for check in certificate.broken)


def _broken(certificate: Certificate | None) -> int:
    return len(certificate.broken) if certificate else 10**6


def _sentence(found: Result, certificate: Certificate | None, now: Round) -> str:
    given = {**now.margins["rate_margin"], **now.margins["contact_margin"]}
    told = ", ".join(f"{name} {share:.2%}" for name, share in given.items())
    at = f"N = {found.plan.intervals}" + (", corrected" if now.corrected else "")
    at += f", margins {told}" if told else ""
    if certificate is None:
        return f"{at}: {found.solved.outcome.claim}"
    verdict = "certified" if certificate.certified else certificate.reasons[0]
    return f"{at}: {found.plan.travel_time:.4f} s, {verdict}"
