"""Another strategy from many starts: how often it succeeds, and which optima it finds."""

from __future__ import annotations

from dataclasses import replace
from typing import final

from pydantic import ConfigDict, InstanceOf
from pydantic.dataclasses import dataclass

from benchbench.analysis.wilson import wilson
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.sizes import Tries
from benchbench.planning.case import Case, Strategy
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge, planned

SAME = 1e-4
"""Optima whose costs differ by less than this share of them are one."""


@final
@dataclass(frozen=True, config=ConfigDict(arbitrary_types_allowed=True))
class Multistart(Strategy):
    """Run `of` from `starts` seeds and return the best certified plan, else the best claimed one.

    With seed s of the case the starts have the seeds s n to s n + n - 1, n = `starts`: each can be run again alone, and
    that of seed 0 is the guess itself. The account tells the success rate with its Wilson interval and the optima.
    """

    of: InstanceOf[Strategy]
    starts: Tries = 10

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Solve, judge, count; spent time ends it early."""
        found: list[tuple[Result, bool]] = []
        for i in range(self.starts):
            result = planned(self.of, replace(case, seed=case.seed * self.starts + i), ledger)
            found.append((result, judge(result, case, ledger).certified))
            if ledger.over:
                break
        best, _ = min(found, key=lambda one: (not one[1], one[0].objective))
        rate = wilson(sum(certified for _, certified in found), len(found))
        return best.telling(
            starts=rate.runs, starts_certified=rate.successes, starts_low=rate.low, starts_high=rate.high,
            optima=_optima(found),
        )  # fmt: skip


def _optima(found: list[tuple[Result, bool]]) -> list[str]:
    """Each optimum in words, the best first; of failed solves only the number."""
    groups: list[list[tuple[Result, bool]]] = []
    for one in sorted((f for f in found if f[0].claimed), key=lambda one: one[0].objective):
        if groups and one[0].objective - groups[-1][0][0].objective <= SAME * abs(one[0].objective):
            groups[-1].append(one)
        else:
            groups.append([one])
    told = [_told(group) for group in groups]
    failed = sum(not result.claimed for result, _ in found)
    return [*told, f"{failed} not solved"] if failed else told


def _told(group: list[tuple[Result, bool]]) -> str:
    plan, certified = group[0][0].plan, sum(good for _, good in group)
    when = ", ".join(f"{plan.time[[a, b]].mean():.3f}" for a, b in plan.contacts)
    contact = f", contact at {when} s" if when else ""
    return f"{plan.travel_time:.4f} s{contact}: {len(group)} starts, {certified} certified"
