"""The condition of a gate, and the two ways to impose gates on a flight: at chosen nodes, or by progress.

Progress (complementary progress constraints, Foehn, Romero & Scaramuzza 2021, doi:10.1126/scirobotics.abh1221): of
each gate i a variable kappa^i falls from 1 to 0 along the nodes, by

    mu^i_k = kappa^i_k - kappa^i_{k+1} >= 0   only where   h_i(x_k) <= 0,  of a ball  |p_k - w_i|^2 / r_i^2 - 1 <= 0,

and kappa^i <= kappa^{i+1} keeps the order. Their slack nu in mu (|p - w|^2 - nu) <= 0.01 is not needed, because the
pair is a vanishing one; that 0.01 lets flights miss a gate of 0.3 m by 0.42 m. A gate is touched at a node.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.formulation.gate_conditions import GateCondition, conditions
from benchbench.ground.arrays import Array, Index
from benchbench.mpcc.problem import Block, Mpcc, Pair, Slot, Variable, block, rows
from benchbench.ocp.model import Model
from benchbench.ocp.race import Race
from benchbench.ocp.track import Gate


@dataclass(frozen=True)
class StatePlace:
    """Where a flight has its state.

    Position in the first three of the `width` columns of `variable`, velocity in those of the `rates` columns of v.
    Without a model (a point mass) nothing is asked of the attitude.
    """

    variable: str
    width: int
    rates: int
    model: Model | None = None

    def knows(self, condition: GateCondition) -> bool:
        """Whether there is what the condition reads."""
        return condition.reads != "attitude" or self.model is not None

    def at(self, condition: GateCondition, nodes: Sequence[int] | Index) -> Slot:
        """What the condition reads, at each of the nodes."""
        name, width = ("v", self.rates) if condition.reads == "velocity" else (self.variable, self.width)
        read = width if condition.reads == "attitude" else 3
        return Slot(name, rows(name, width, nodes).index[:, :read])

    def h(self, condition: GateCondition) -> tuple[ca.SX, ca.SX, ca.SX]:
        """The condition with the symbols of its unknowns, as `at` gives them, and of its numbers."""
        numbers = ca.SX.sym("numbers", condition.count)
        z = ca.SX.sym("z", self.width if condition.reads == "attitude" else 3)
        state = self.model.nose(z) if self.model and condition.reads == "attitude" else z
        return condition.h(state, numbers), z, numbers


def at_nodes(race: Race, place: StatePlace, nodes: Sequence[int], goals: Sequence[Gate]) -> tuple[Block, ...]:
    """Impose each gate at its node, a block for each kind of condition."""
    found = []
    for condition, (which, numbers) in _kinds(race, place, goals).items():
        h, z, p = place.h(condition)
        function = ca.Function(condition.name, [z, p, ca.SX.sym("sigma")], [h])
        none = np.zeros((len(which), h.shape[0]))
        slots = (place.at(condition, [nodes[i] for i in which]),)
        found.append(
            Block(
                f"gate_{condition.name}", function, slots,
                parameters=numbers, lower=none - np.inf, upper=none, unit="1",
            )
        )  # fmt: skip
    return tuple(found)


def _kinds(
    race: Race, place: StatePlace, goals: Sequence[Gate]
) -> dict[GateCondition, tuple[list[int], Array]]:
    """For each kind of condition the gates that ask for it, and their numbers (gates, count)."""
    found: dict[GateCondition, list[tuple[int, tuple[float, ...]]]] = {}
    for i, gate in enumerate(goals):
        for condition, numbers in conditions(gate, race.gate_margin):
            if place.knows(condition):
                found.setdefault(condition, []).append((i, numbers))
    return {kind: ([i for i, _ in rows_], np.array([n for _, n in rows_])) for kind, rows_ in found.items()}


def by_progress(race: Race, place: StatePlace, intervals: int) -> Mpcc:
    """Let progress variables kappa (N + 1, gates) say where the gates are passed; the end is not among them.

    Where the order of the race is free nothing ties the gates together.
    """
    gates = len(race.goals) - 1
    low, high = (np.full((intervals + 1, gates), bound) for bound in (0.0, 1.0))
    low[0], high[-1] = 1.0, 0.0
    kappa = Variable("kappa", low, high, np.linspace(high[0], low[-1], intervals + 1), "1", True)
    pairs = tuple(
        _pair(place, condition, intervals, gates, np.array(which)[same], numbers[same])
        for condition, (which, numbers) in _kinds(race, place, race.goals[:-1]).items()
        for same in _alike(condition, numbers)
    )
    order = () if race.order == "free" else (_order(intervals, gates),)
    return Mpcc((kappa,), (_progress(intervals, gates), *order), (), pairs)


def passed_at(intervals: int, nodes: Sequence[int]) -> Array:
    """Progress kappa (N + 1, gates) of flights that pass each gate at one node."""
    return np.where(np.arange(intervals + 1)[:, None] <= np.asarray(nodes), 1.0, 0.0)


def _alike(condition: GateCondition, numbers: Array) -> list[Index]:
    """Rows of numbers that may share a block: of a gap those with the same limit, else all."""
    limits = numbers[:, -1] if condition.gap else np.zeros(len(numbers))
    return [np.flatnonzero(limits == limit) for limit in np.unique(limits)]


def _pair(
    place: StatePlace, condition: GateCondition, intervals: int, gates: int, which: Index, numbers: Array
) -> Pair:
    """Vanishing pairs mu, h at all nodes but the last, of those gates (columns of kappa)."""
    nodes = np.repeat(np.arange(intervals), len(which))
    h, z, p = place.h(condition)
    kappa = ca.SX.sym("kappa", 2)
    out = ca.vertcat(ca.repmat(kappa[0] - kappa[1], h.shape[0], 1), h)
    function = ca.Function(f"progress_{condition.name}", [ca.vertcat(kappa, z), p, ca.SX.sym("sigma")], [out])
    now = nodes * gates + np.tile(which, intervals)
    slots = (_two(now, now + gates), place.at(condition, nodes))
    none = np.zeros((len(nodes), 2 * h.shape[0]))
    limit = (float(numbers[0, -1]),) if condition.gap else None
    paired = Block(
        condition.name, function, slots,
        parameters=np.tile(numbers, (intervals, 1)), lower=none, upper=none, unit=condition.unit,
    )  # fmt: skip
    return Pair(paired, "vanishing", limit, sign_known=True)


def _progress(intervals: int, gates: int) -> Block:
    """Ask for mu >= 0."""
    k = np.arange(intervals * gates)
    return _difference("progress", k, k + gates)


def _order(intervals: int, gates: int) -> Block:
    """Ask for kappa^{i+1} >= kappa^i between the ends."""
    k = np.arange((intervals + 1) * gates).reshape(-1, gates)[1:-1, :-1].ravel()
    return _difference("gate_order", k + 1, k)


def _difference(name: str, left: Index, right: Index) -> Block:
    """Ask for kappa[left] >= kappa[right], flat positions; kappa in [0, 1] bounds their difference from above."""
    slots = [_two(left, right)]
    return block(name, slots, lambda z: z[0] - z[1], upper=np.inf, unit="1", function="difference")


def _two(left: Index, right: Index) -> Slot:
    return Slot("kappa", np.stack([left, right], axis=1).astype(np.int64))
