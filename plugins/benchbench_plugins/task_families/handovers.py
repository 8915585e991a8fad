"""Handovers: one target, met beside the way from start to end."""

from __future__ import annotations

from typing import Any, final

from pydantic import ConfigDict
from pydantic.dataclasses import dataclass

from benchbench.ocp.scenario import Positive
from benchbench.ocp.task_family import Between, Counts, Draws, TaskFamily, rounded
from benchbench_plugins.task_families.targets import Targets
from benchbench_plugins.task_families.way import Way


@final
@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Handovers(TaskFamily):
    """One target, met beside the way from start to end.

    way             where start, end and target are, see `Way`
    along           where on the way the target is met, share of it
    targets         how the target moves, see `Targets`
    kappa_init      nodes in contact
    contact_step_s  s from one of them to the next; null: as long as a step of the grid is
    """

    way: Way
    along: Between
    targets: Targets
    kappa_init: Counts
    contact_step_s: Positive | None = None

    def draw(self, draws: Draws) -> dict[str, Any]:
        """Return start, end, target and contact."""
        place, time = self.way.beside(draws, "target", draws.number("along", self.along))
        count = draws.whole("kappa_init", self.kappa_init)
        step = self.contact_step_s
        return {
            **self.way.ends(draws),
            "target": self.targets.draw(draws, "target", place, time),
            "kappa_init": count,
            **({} if step is None else {"contact_seconds": rounded((count - 1) * step)}),
        }
