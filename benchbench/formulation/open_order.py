"""Several stops left to the optimiser: which of them, and in what order, as complementarity.

Stop i has progress variables kappa^i_k, of which kappa^i_0 = kappa_init y_i are to come, and the progress index
eps^i_k = kappa^i_k - kappa^i_{k+1}; y_i is 1 where the stop is made and 0 where it is left out.

    all, fixed order   0 <= eps^j_k  perpendicular to  kappa^i_k >= 0  for i before j: first what is before
    all, free order    0 <= eps^i_k  perpendicular to  eps^j_k >= 0: never two at once
    one of several     sum y_i = 1,  0 <= y_i  perpendicular to  y_j >= 0
    optional           0 <= y_i  perpendicular to  1 - y_i >= 0, and the cost - reward_i y_i
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import casadi as ca
import numpy as np

from benchbench.arrays import Array
from benchbench.formulation.coupling import Coupling
from benchbench.mpcc.problem import Block, Mpcc, Pair, Slot, Variable, rows
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
    z, one = ca.SX.sym("z", count), np.ones((1, 1))
    total = replace(_block("one_stop", z, ca.sum1(z), [rows(MADE, count, [0])], 1), lower=one, upper=one)
    first, second = zip(*combinations(range(count), 2), strict=True)
    z = ca.SX.sym("z", 2)
    return Mpcc(
        (), (total,), (), (_pair("stop_or_stop", "two", z, z, [rows(MADE, 1, first), rows(MADE, 1, second)]),)
    )


def _skip(itinerary: Itinerary) -> Mpcc:
    """Each stop that may be left out is made or not."""
    z, which = ca.SX.sym("z"), [i for i, stop in enumerate(itinerary.stops) if itinerary.may_skip(stop)]
    return Mpcc(pairs=(_pair("stop_or_not", "zero_or_one", z, ca.vertcat(z, 1 - z), [rows(MADE, 1, which)]),))


def _links(itinerary: Itinerary) -> Iterator[Block]:
    """kappa_0 = kappa_init y for every stop."""
    z, p = ca.SX.sym("z", 2), ca.SX.sym("p")
    for i, stop in enumerate(itinerary.stops):
        slots = [rows(f"{stop.prefix}kappa", 1, [0]), rows(MADE, 1, [i])]
        block = _block("stop_made", z, z[0] - p * z[1], slots, 1, p, np.array([[float(stop.kappa_init)]]))
        yield replace(block, name=f"{stop.prefix}{MADE}")


def _rewards(itinerary: Itinerary) -> tuple[Block, ...]:
    if all(stop.reward is None for stop in itinerary.stops):
        return ()
    z, p, count = ca.SX.sym("z"), ca.SX.sym("p"), len(itinerary.stops)
    worth = -_column(stop.reward or 0.0 for stop in itinerary.stops)
    return (_block("reward", z, p * z, [rows(MADE, 1, range(count))], count, p, worth),)


def _fixed_order(itinerary: Itinerary, n: int) -> Iterator[Pair]:
    """Each stop waits for the one before, and for those before that as long as the ones between may be left out."""
    z = ca.SX.sym("z", 3)
    for j, later in enumerate(itinerary.stops):
        for earlier in reversed(itinerary.stops[:j]):
            slots = [*_progress(later, n), rows(f"{earlier.prefix}kappa", 1, range(n))]
            name = f"{earlier.name}_before_{later.name}"
            yield _pair(name, "in_order", z, ca.vertcat(z[0] - z[1], z[2]), slots)
            if not itinerary.may_skip(earlier):
                break


def _free_order(itinerary: Itinerary, n: int) -> Iterator[Pair]:
    """No node serves two stops."""
    z = ca.SX.sym("z", 4)
    for one, other in combinations(itinerary.stops, 2):
        slots = [*_progress(one, n), *_progress(other, n)]
        both = ca.vertcat(z[0] - z[1], z[2] - z[3])
        yield _pair(f"{one.name}_or_{other.name}", "not_at_once", z, both, slots)


def _progress(stop: Stop, n: int) -> list[Slot]:
    """Where kappa_k and kappa_{k+1} of each node are."""
    return [rows(f"{stop.prefix}kappa", 1, nodes) for nodes in (range(n), range(1, n + 1))]


def _pair(name: str, function: str, z: ca.SX, both: ca.SX, slots: Sequence[Slot]) -> Pair:
    block = _block(function, z, both, slots, len(slots[0].index))
    return Pair(replace(block, name=name), "complementarity", sign_known=True)


def _block(
    name: str, z: ca.SX, out: ca.SX, slots: Sequence[Slot], count: int, p: ca.SX | None = None,
    numbers: Array | None = None,
) -> Block:  # fmt: skip
    symbols = [z, ca.SX.sym("p", 0) if p is None else p, ca.SX.sym("sigma")]
    parameters = np.zeros((count, 0)) if numbers is None else numbers
    none = np.zeros((count, out.shape[0]))
    return Block(name, ca.Function(name, symbols, [out]), tuple(slots), parameters, none, none, "1")


def _column(values: Iterable[float]) -> Array:
    return np.array([[float(value)] for value in values])
