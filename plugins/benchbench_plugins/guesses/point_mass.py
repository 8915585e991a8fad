"""A start from what limits time most: the time-optimal flight of a point mass."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case, Guess


@final
@dataclass(frozen=True)
class PointMass(Guess):
    """Time-optimal flight of a point mass with the vehicle's thrust and speed, over the target or through the gates."""

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """One small solve."""
        return posing.point_mass(case, ledger)
