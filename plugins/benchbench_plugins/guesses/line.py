"""The plain start that benchmarks of relaxations use."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench import posing
from benchbench.case import Case, Ledger
from benchbench.guess import Guess
from benchbench.plan import Plan


@final
@dataclass(frozen=True)
class Line(Guess):
    """Straight line over the target, contact where the scenario guesses it; or from gate to gate."""

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing."""
        return posing.line(case)
