"""Margins as large as the replay asks for: solve without, fly, take back what a limit was exceeded by, solve again.

A transcription keeps limits at its nodes, the certificate asks for them between the nodes as well. A margin that is fixed
beforehand costs travel time where none is needed, and is too small where the grid is coarse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import singledispatch

import numpy as np

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.limited import Limited
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.handover import Handover
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge

ROUNDS = 3
"""Solves that may follow the first."""
AGAIN = 1.1
"""What was exceeded is taken back with so much more, because the next plan flies differently."""

BEST_ONLY = "; margins for the best one only"
"""What the account of a search says whose candidates were solved without margins."""

Margins = dict[str, dict[str, float]]
"""Margins by the name of the field of the scenario."""
NONE: Margins = {"rate_margin": {}, "contact_margin": {}}


def measured(
    case: Case, ledger: Ledger, most: float, solve: Callable[[Case, Result | None], Result]
) -> Result:
    """Solve, from nothing or from an earlier result, until the certificate accepts or a margin would exceed `most`.

    Returns the certified result, with the account of the first solve; without one the first, which has no margins but those
    kept (`least_margins`), on top of which others are measured. With `most` 0 nothing is measured: the one solve has the
    margins of the scenario.
    """
    if not most:
        return solve(case, None)
    margins = least = least_margins(case.scenario, most)
    first = last = solve(with_margins(case, margins), None)
    for _ in range(ROUNDS):
        if not last.claimed or ledger.over:
            return first
        certificate = judge(last, case, ledger)
        if certificate.certified:
            return last
        raised = taken_back(margins, certificate, case)
        if raised == margins or beyond(raised, least) > most:
            return first
        margins = raised
        last = of_the_search(first, solve(with_margins(case, margins), last))
    return last if last.claimed and judge(last, case, ledger).certified else first


def of_the_search(first: Result, last: Result) -> Result:
    """The last result with the account of the first, whose search, if it was one, knew no margins."""
    searched = {"search": f"{first.account['search']}{BEST_ONLY}"} if "search" in first.account else {}
    return last.telling(**{**first.account, **searched})


def with_margins(case: Case, margins: Margins) -> Case:
    """Return the case with these margins instead of its own."""
    return replace(case, scenario=keeping(case.scenario, margins))


@singledispatch
def keeping(scenario: Scenario, margins: Margins) -> Scenario:
    """Return the scenario with these margins, of those that its kind has."""
    return scenario.model_copy(update={"rate_margin": margins["rate_margin"]})


@keeping.register
def _(scenario: Handover, margins: Margins) -> Scenario:
    return scenario.model_copy(update=margins)


def own_margins(scenario: Scenario) -> Margins:
    """Return the margins that a scenario comes with, of those that its kind has."""
    return {field: dict(getattr(scenario, field, {})) for field in NONE}


def least_margins(scenario: Scenario, most: float) -> Margins:
    """Return the margins that any plan is made with: where none may be measured (`most` 0) all of the scenario, else those kept."""
    own = own_margins(scenario)
    if not most:
        return own
    kept = scenario.kept_margins
    return {field: {n: m for n, m in own[field].items() if f"{field}.{n}" in kept} for field in own}


def beyond(margins: Margins, least: Margins) -> float:
    """By how much the largest of all margins exceeds what is kept anyway, 0 where none does; infinite where nothing is left of a limit."""
    over = [
        m - least[field].get(n, 0.0) if m < 1 else np.inf
        for field, own in margins.items() for n, m in own.items()
    ]  # fmt: skip
    return max([0.0, *over])


def taken_back(margins: Margins, found: Certificate, case: Case) -> Margins:
    """Margins with what the replay exceeded taken back; the same where it broke other limits only."""
    rates, contacts = dict(margins["rate_margin"]), dict(margins["contact_margin"])
    if found.flight is not None:
        reached = np.max(Limited.of(case.model.velocity, found.flight.velocity).ratio, axis=0)
        for name, ratio in zip(case.model.velocity.names, reached, strict=True):
            if ratio > case.limits.rate_ratio:
                rates[name] = rates.get(name, 0.0) + AGAIN * float(ratio - case.limits.rate_ratio)
    limits = {name: c.limit for stop in case.scenario.itinerary.stops for name, c in stop.contacts.items()}
    for name, limit in limits.items():
        named = [f"{where}_{name}" for where in ("contact", "contact_node", "replay_path", "path")]
        flown = [c for c in found.broken if c.name in named]
        beyond = max((c.value - c.limit for c in flown), default=0.0)
        if beyond > 0 and np.isfinite(beyond):
            contacts[name] = contacts.get(name, 0.0) + AGAIN * beyond / limit + 1e-4
    return {"rate_margin": rates, "contact_margin": contacts}
