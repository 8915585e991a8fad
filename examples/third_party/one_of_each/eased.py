"""A start that is at rest where the vehicle has to be."""

from __future__ import annotations

from dataclasses import replace
from typing import final

import numpy as np
from pydantic.dataclasses import dataclass

import benchbench as bb
from benchbench.planning import posing


@final
@dataclass(frozen=True)
class Eased(bb.Guess):
    """The straight line over the targets, its speed a half wave of a sine on each leg instead of constant.

    It starts and ends at rest, as a flight does; the line jumps to its speed in the first interval.
    """

    def plan(self, case: bb.Case, ledger: bb.Ledger) -> bb.Plan:
        """Costs nothing."""
        line = posing.line(case)
        corners = line.time[sorted({0, *(first for first, _ in line.contacts), line.intervals})]
        leg = np.clip(np.searchsorted(corners, line.time, side="right") - 1, 0, len(corners) - 2)
        begin, end = corners[leg], corners[leg + 1]
        eased = begin + (end - begin) * (1 - np.cos(np.pi * (line.time - begin) / (end - begin))) / 2
        q = np.stack([np.interp(eased, line.time, column) for column in line.configuration.T], axis=-1)
        if (
            case.model.configuration.names != case.model.velocity.names
        ):  # rates of quaternions are another matter
            return replace(line, configuration=q)
        return replace(line, configuration=q, velocity=np.gradient(q, line.time, axis=0))
