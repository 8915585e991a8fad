"""Contact audit, stop by stop: which nodes claim contact, which hold every condition, what the replay does."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchbench.certificate.evidence import Evidence
from benchbench.certificate.limits import Limits
from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array, Flags
from benchbench.ocp.contact import Contact
from benchbench.ocp.model import Plant
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Itinerary, Stop


@dataclass(frozen=True, eq=False)
class Audit:
    """What was found at one stop; `planned` (N + 1,) and `replayed` (m,) gaps by contact, in the contact's unit.

    progress (N + 1,) progress index that the plan claims for this stop
    claims   (N + 1,) nodes whose progress index says contact
    window   first and last node of the longest run of nodes that claim contact and hold every condition,
             None without any
    dense    (m,) samples of the replay inside the window, both ends included
    """

    stop: Stop
    planned: dict[str, Array]
    replayed: dict[str, Array]
    progress: Array
    claims: Flags
    window: tuple[int, int] | None
    dense: Flags

    @property
    def steps(self) -> int:
        """Number of nodes in the window."""
        return 0 if self.window is None else self.window[1] - self.window[0] + 1

    def worst_planned(self, name: str) -> int:
        """Node of the largest planned gap among those that claim contact; NaN counts as largest."""
        return _argmax(self.planned[name], self.claims)

    def worst_replayed(self, name: str) -> int:
        """Sample of the largest replayed gap in the window; NaN counts as largest."""
        return _argmax(self.replayed[name], self.dense)

    def path_nodes(self, contact: Contact) -> Flags:
        """Nodes (N + 1,) at which a path condition must hold."""
        last = None if self.window is None else self.window[1]
        return self._path(contact, len(self.claims), last)

    def path_samples(self, contact: Contact) -> Flags:
        """Samples (m,) of the replay at which it must hold."""
        last = None if self.window is None else int(np.flatnonzero(self.dense)[-1])
        return self._path(contact, len(self.dense), last)

    def _path(self, contact: Contact, count: int, last: int | None) -> Flags:
        """All of so many; of what is kept until the contact is over those up to its last one, none where none is claimed."""
        if contact.kept == "always" or (last is None and self.claims.any()):
            return np.ones(count, bool)
        return np.arange(count) <= (-1 if last is None else last)


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactEvidence(Evidence):
    """What was measured on a plan that makes stops: one audit for each, in the order of the scenario."""

    audits: tuple[Audit, ...]

    @property
    def asked(self) -> list[Audit]:
        """Stops whose contact must be long enough: those that have to be made, and those that the plan claims."""
        itinerary = self.scenario.itinerary
        return [one for one in self.audits if one.claims.any() or not itinerary.may_skip(one.stop)]

    @property
    def made(self) -> list[Audit]:
        """Those of them with a contact, in order of time."""
        return sorted((one for one in self.asked if one.window), key=lambda one: one.window or (0, 0))


def audit(
    plan: Plan, flight: Replay, itinerary: Itinerary, plant: Plant, limits: Limits
) -> tuple[Audit, ...]:
    """Measure every contact of every stop at the planned nodes and on the replay.

    A node counts as contact only if all conditions hold there to `limits.node`: a progress index of 0.02
    does not buy fifty times the speed. A stop that the plan does not know is one that it does not claim.
    """
    return tuple(_audit(plan, flight, stop, plant, limits) for stop in itinerary.stops)


def _audit(plan: Plan, flight: Replay, stop: Stop, plant: Plant, limits: Limits) -> Audit:
    planned = _gaps(stop, plant, plan.time, plan.configuration, plan.velocity)
    replayed = _gaps(stop, plant, flight.time, flight.configuration, flight.velocity)
    known = stop.name in plan.stop_names
    progress = (
        plan.progress_by_stop[:, plan.stop_names.index(stop.name)] if known else np.zeros(len(plan.time))
    )
    claims = progress > limits.contact_claim
    holds = claims.copy()
    for name, contact in event_contacts(stop):
        holds &= planned[name] <= contact.limit + limits.node
    window = longest_run(holds)
    dense = np.zeros(len(flight.time), bool)
    if window is not None:
        dense[flight.nodes[window[0]] : flight.nodes[window[1]] + 1] = True
    return Audit(stop, planned, replayed, progress, claims, window, dense)


def claimed(plan: Plan, itinerary: Itinerary, plant: Plant, limits: Limits) -> Plan:
    """Return a plan that says nothing of contact with a claim, at each stop, to the longest run of nodes that hold everything.

    A plan that says that there is none is left as it is.
    """
    if not np.isnan(plan.progress).all():
        return plan
    progress = np.zeros((len(plan.time), len(itinerary.stops)))
    for column, stop in zip(progress.T, itinerary.stops, strict=True):
        if not any(True for _ in event_contacts(stop)):
            continue
        gaps = _gaps(stop, plant, plan.time, plan.configuration, plan.velocity)
        holds = np.ones(len(plan.time), bool)
        for name, contact in event_contacts(stop):
            holds &= gaps[name] <= contact.limit + limits.node
        if window := longest_run(holds):
            column[window[0] : window[1] + 1] = 1.0
    return replace(plan, progress=progress, stop_names=tuple(stop.name for stop in itinerary.stops))


def event_contacts(stop: Stop) -> Iterator[tuple[str, Contact]]:
    """Contacts that must hold together at the event."""
    return ((n, c) for n, c in stop.contacts.items() if c.kept == "in contact")


def path_contacts(stop: Stop) -> Iterator[tuple[str, Contact]]:
    """Conditions that must hold all the time, or until the contact is over."""
    return ((n, c) for n, c in stop.contacts.items() if c.kept != "in contact")


def longest_run(flags: Flags) -> tuple[int, int] | None:
    """First and last position of the longest stretch of True, the first of equals; None without any."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    if not len(edges):
        return None
    longest = int(np.argmax(edges[1::2] - edges[::2]))
    return int(edges[2 * longest]), int(edges[2 * longest + 1]) - 1


def _gaps(stop: Stop, plant: Plant, time: Array, q: Array, v: Array) -> dict[str, Array]:
    position, velocity = sample(stop.target, time)
    with np.errstate(invalid="ignore"):
        return {name: c.gap(plant, q, v, position, velocity) for name, c in stop.contacts.items()}


def _argmax(values: Array, where: Flags) -> int:
    return int(np.argmax(np.where(where, np.where(np.isnan(values), np.inf, values), -np.inf)))
