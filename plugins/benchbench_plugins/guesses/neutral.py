"""A start that takes no side: neither when, nor in which order, nor whether stops are made."""

from __future__ import annotations

from typing import final

import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.formulation.handover import WHOLE
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case, Guess
from benchbench.planning.guess import hovering


@final
@dataclass(frozen=True)
class Neutral(Guess):
    """Straight line from start to end at hover; the progress of every stop is spread over all nodes.

    A stop that may be left out is half made, one of several in equal shares.
    """

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing."""
        scenario, itinerary = case.scenario, case.scenario.itinerary
        n = scenario.grid_intervals
        share = np.linspace(0.0, 1.0, n + 1)
        start, end = scenario.start_point(case.model), scenario.end_point(case.model)
        progress = np.zeros((n + 1, len(itinerary.stops)))
        for i, stop in enumerate(itinerary.stops):
            made = 1 / len(itinerary.stops) if itinerary.visit == "one" else 0.5
            made = made if itinerary.may_skip(stop) else 1.0
            progress[:-1, i] = min(made * stop.kappa_init / n, WHOLE)
        time, line = share * scenario.travel_time_guess, start + share[:, None] * (end - start)
        return hovering(case, time, line, progress)
