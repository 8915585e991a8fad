"""Several stops left to the optimiser: which of them, and in what order, as complementarity.

Stop i has progress variables kappa^i_k, of which kappa^i_0 = kappa_init y_i are to come, and the progress index
eps^i_k = kappa^i_k - kappa^i_{k+1}; y_i is 1 where the stop is made and 0 where it is left out.

    all, fixed order   0 <= eps^j_k  perpendicular to  kappa^i_k >= 0  for i before j: first what is before
    all, free order    0 <= eps^i_k  perpendicular to  eps^j_k >= 0: never two at once
    one of several     sum y_i = 1,  0 <= y_i  perpendicular to  y_j >= 0
    optional           0 <= y_i  perpendicular to  1 - y_i >= 0, and the cost - reward_i y_i
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import combinations

import casadi as ca
import numpy as np

from benchbench.formulation.coupling import Coupling
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, Slot, Variable, block, rows
from benchbench.ocp.stop import Itinerary, Stop

MADE = "made"
"""Name of the variable y, (stops, 1)."""


def by_progress(itinerary: Itinerary, couplings: Sequence[Coupling]) -> Mpcc:
    """Progress variables and conditions of all stops, with everything that ties them together."""
    decided, n = itinerary.visit == "all", couplings[0].trajectory.grid.intervals
    total = choice(itinerary, None)
    for stop, coupling in zip(itinerary.stops, couplings, strict=True):
        total += coupling.by_progress(stop.kappa_init, decided)
    links = () if decided else tuple(_links(itinerary))
    ties = {"fixed": _fixed_order, "free": _free_order}[itinerary.order]
    return total + Mpcc((), links, (), tuple(ties(itinerary, n)) if itinerary.visit != "one" else ())


def choice(itinerary: Itinerary, made: Collection[Stop] | None) -> Mpcc:
    """The variable y where there is a choice, and what the choice costs; `made` are the stops of one that is fixed."""
    if itinerary.visit == "all":
        return Mpcc()
    stops = itinerary.stops
    even = 1 / len(stops) if itinerary.visit == "one" else 0.5
    low, high = _column(not itinerary.may_skip(stop) for stop in stops), np.ones((len(stops), 1))
    if made is not None:
        low = high = _column(stop in made for stop in stops)
    y = Variable(MADE, low, high, np.clip(np.full(low.shape, even), low, high), "1", True)
    part = Mpcc((y,), (), _rewards(itinerary))
    if made is not None:
        return part
    return part + (_one(len(stops)) if itinerary.visit == "one" else _skip(itinerary))


def _one(count: int) -> Mpcc:
    """Exactly one of all."""
    total = block("one_stop", [rows(MADE, count, [0])], ca.sum1, 1.0, 1.0, unit="1")
    slots = [rows(MADE, 1, which) for which in zip(*combinations(range(count), 2), strict=True)]
    either = _pair("stop_or_stop", slots, lambda one, other: [one, other], function="two")
    return Mpcc((), (total,), (), (either,))


def _skip(itinerary: Itinerary) -> Mpcc:
    """Each stop that may be left out is made or not."""
    which = [i for i, stop in enumerate(itinerary.stops) if itinerary.may_skip(stop)]
    slots = [rows(MADE, 1, which)]
    return Mpcc(pairs=(_pair("stop_or_not", slots, lambda y: [y, 1 - y], function="zero_or_one"),))


def _links(itinerary: Itinerary) -> Iterator[Block]:
    """kappa_0 = kappa_init y for every stop."""
    for i, stop in enumerate(itinerary.stops):
        yield block(
            f"{stop.prefix}{MADE}", [rows(f"{stop.prefix}kappa", 1, [0]), rows(MADE, 1, [i])],
            lambda kappa, y, p: kappa - p * y, parameters=_column([stop.kappa_init]), unit="1",
            function="stop_made",
        )  # fmt: skip


def _rewards(itinerary: Itinerary) -> tuple[Block, ...]:
    if all(stop.reward is None for stop in itinerary.stops):
        return ()
    worth = -_column(stop.reward or 0.0 for stop in itinerary.stops)
    slots = [rows(MADE, 1, range(len(worth)))]
    return (block("reward", slots, lambda y, p: p * y, parameters=worth, unit="1"),)


def _fixed_order(itinerary: Itinerary, n: int) -> Iterator[Pair]:
    """Each stop waits for the one before, and for those before that as long as the ones between may be left out."""
    for j, later in enumerate(itinerary.stops):
        for earlier in reversed(itinerary.stops[:j]):
            slots = [*_progress(later, n), rows(f"{earlier.prefix}kappa", 1, range(n))]
            yield _pair(f"{earlier.name}_before_{later.name}", slots, _in_order, function="in_order")
            if not itinerary.may_skip(earlier):
                break


def _free_order(itinerary: Itinerary, n: int) -> Iterator[Pair]:
    """No node serves two stops."""
    for one, other in combinations(itinerary.stops, 2):
        slots = [*_progress(one, n), *_progress(other, n)]
        yield _pair(f"{one.name}_or_{other.name}", slots, _not_at_once, function="not_at_once")


def _in_order(now: ca.SX, then: ca.SX, to_come: ca.SX) -> list[ca.SX]:
    return [now - then, to_come]


def _not_at_once(now: ca.SX, then: ca.SX, other_now: ca.SX, other_then: ca.SX) -> list[ca.SX]:
    return [now - then, other_now - other_then]


def _progress(stop: Stop, n: int) -> list[Slot]:
    """Where kappa_k and kappa_{k+1} of each node are."""
    return [rows(f"{stop.prefix}kappa", 1, nodes) for nodes in (range(n), range(1, n + 1))]


def _pair(name: str, slots: Sequence[Slot], rule: Callable[..., list[ca.SX]], function: str) -> Pair:
    return Pair(block(name, slots, rule, unit="1", function=function), "complementarity", sign_known=True)


def _column(values: Iterable[float]) -> Array:
    return np.array([[float(value)] for value in values])
