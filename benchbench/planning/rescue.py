"""What to do where a first solve fails: look for a flight with slack, which gives another start or says what conflicts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.model import Coordinates
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Stop
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.elastic import Eased, ease
from benchbench.planning.prices import of_rows, prices

PATIENCE = 250
"""Iterations of a solve with slack: 20 to 160 are usual."""
MOST = 2
"""Demands that are named on either side."""
SHARE = 0.2
"""Part of the largest price from which a limit is named beside it."""


ALIKE = 1e-2
"""Share by which the least slack of two starts may differ where they say the same."""


@dataclass(frozen=True)
class Rescue:
    """A plan without slack to start from; or what conflicts; or neither.

    slack     the least slack that each start ended with that a solver was content with
    conflict  in words, where every start ended with slack, or one with as much as an earlier look
    """

    plan: Plan | None = None
    conflict: str = ""
    slack: tuple[float, ...] = ()


def rescue(case: Case, ledger: Ledger, starts: Sequence[Plan], before: Sequence[float] = ()) -> Rescue:
    """Solve with slack from each start until one ends without; nothing is found where forces of contact are part of the problem.

    before: the least slack that earlier looks ended with, from other starts.
    """
    limited = replace(case, iteration_limit=min(PATIENCE, case.iteration_limit))
    found: list[Eased] = []
    for start in starts:
        if ledger.over:
            break
        with ledger.building():
            problem = posing.phases(case, start)
        if problem.mpcc.pairs:
            return Rescue()
        found.append(ease(problem, limited, ledger, "slack"))
        if found[-1].feasible:
            return Rescue(found[-1].result.plan)
        if found[-1].conflicts and any(_alike(found[-1].total, one) for one in before):
            return Rescue(conflict=told(found[-1], case))
    left = [one for one in found if one.conflicts]
    if len(left) < len(starts):
        return Rescue(slack=tuple(one.total for one in left))
    return Rescue(conflict=told(min(left, key=lambda one: one.total), case))


def _alike(one: float, other: float) -> bool:
    return abs(one - other) <= ALIKE * min(one, other)


def told(eased: Eased, case: Case) -> str:
    """Return in words what is missed at least, and the limits of the vehicle and of contacts at which easing would help most."""
    missed = [text for _, text in sorted(_missed(eased, case), reverse=True)[:MOST]]
    helps = sorted((*_prices(eased, case), *_prices_of_contacts(eased, case)), reverse=True)
    named = [text for price, text in helps[:MOST] if price >= SHARE * helps[0][0] and price > 0]
    against = f", against {' and '.join(named)}" if named else ""
    return f"no feasible plan found (no proof); what conflicts most: {' and '.join(missed)}{against}"


def _broken(eased: Eased) -> dict[str, float]:
    """Names of blocks with rows that are broken, each with its slack."""
    left = max(eased.slack.values())
    return {name: slack for name, slack in eased.slack.items() if slack >= 1e-3 * left}


def _contacts(case: Case) -> dict[str, tuple[Stop, str]]:
    return {f"{s.prefix}{name}": (s, name) for s in case.scenario.itinerary.stops for name in s.contacts}


def _missed(eased: Eased, case: Case) -> Iterator[tuple[float, str]]:
    """Rows that are broken, each with its slack."""
    contacts = _contacts(case)
    for name, slack in _broken(eased).items():
        if name == "total_time":
            latest = case.scenario.travel_time[1]
            yield slack, f"the travel time {eased.result.plan.travel_time:.3g} s, allowed {latest:g} s"
        elif name in contacts:
            yield slack, _contact(eased, case, *contacts[name])
        else:
            yield slack, f"'{name}' missed by {slack:.2g} of its scale"


def _contact(eased: Eased, case: Case, made: Stop, name: str) -> str:
    contact, plan = made.contacts[name], eased.result.plan
    nodes = list((eased.result.problem.contact or {}).get(made.name, range(len(plan.time))))
    position, velocity = sample(made.target, plan.time[nodes])
    q, v = plan.configuration[nodes], plan.velocity[nodes]
    gap = float(np.max(contact.gap(case.model.plant(), q, v, position, velocity)))
    return f"{contact.noun}{made.label} {gap:.3g} {contact.unit}, allowed {contact.limit:g} {contact.unit}"


def _prices(eased: Eased, case: Case) -> Iterator[tuple[float, str]]:
    """Limits of the vehicle: how much slack one per cent of easing each would save, by the multipliers of their bounds."""
    named = {"q": case.scenario.limits(case.model), "v": case.model.velocity, "u": case.model.inputs}
    for kind, of in named.items():
        each = prices(eased.result, kind)
        if each is not None:
            yield from _by_name(kind, of, each / 100)


def _prices_of_contacts(eased: Eased, case: Case) -> Iterator[tuple[float, str]]:
    """Conditions of contacts that are kept, but only just: the same price, of their limits; h = (gap / limit)^2 - 1 (`Condition`)."""
    contacts, rows = _contacts(case), of_rows(eased.result)
    for block in rows.keys() & contacts.keys() - _broken(eased).keys():
        made, name = contacts[block]
        contact = made.contacts[name]
        yield 2 * rows[block] / 100, f"{contact.noun}{made.label}, {contact.limit:g} {contact.unit}"


def _by_name(kind: str, of: Coordinates, prices: Array) -> Iterator[tuple[float, str]]:
    """Coordinates one by one; inputs of one name and different numbers together."""
    what = {"q": "limit of", "v": "largest rate of", "u": "limit of"}[kind]
    groups: dict[str, list[int]] = {}
    for i, name in enumerate(of.names):
        groups.setdefault(name.rstrip("0123456789").rstrip("_") if kind == "u" else name, []).append(i)
    for name, members in groups.items():
        low, high, unit = of.lower[members[0]], of.upper[members[0]], of.units[members[0]]
        span = f"{high:.3g} {unit}" if kind == "v" else f"{low:.3g} to {high:.3g} {unit}"
        yield float(np.sum(prices[members])), f"the vehicle's {what} {name}, {span}"
