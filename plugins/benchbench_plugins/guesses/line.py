"""The plain start that benchmarks of relaxations use."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.case import Case, Ledger
from benchbench.guess import Guess, straight_line
from benchbench.plan import Plan


@final
@dataclass(frozen=True)
class Line(Guess):
    """Straight line from start over the target to the end; contact where the scenario guesses it."""

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing."""
        return straight_line(case)
