"""The condition of a gate, and the two ways to impose gates on a flight: at chosen nodes, or by progress.

Progress (complementary progress constraints, Foehn, Romero & Scaramuzza 2021, doi:10.1126/scirobotics.abh1221): of
each gate i a variable kappa^i falls from 1 to 0 along the nodes, by

    mu^i_k = kappa^i_k - kappa^i_{k+1} >= 0   only where   h_i(p_k) = |p_k - w_i|^2 / r_i^2 - 1 <= 0,

and kappa^i <= kappa^{i+1} keeps the order. Their slack nu in mu (|p - w|^2 - nu) <= 0.01 is not needed, because the
pair is a vanishing one; that 0.01 lets flights miss a gate of 0.3 m by 0.42 m. A gate is touched at a node.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.mpcc import Block, Index, Mpcc, Pair, Slot, Variable, rows
from benchbench.plan import Array
from benchbench.race.scenario import Race
from benchbench.race.track import Gate


@dataclass(frozen=True)
class Place:
    """Where a flight has its positions: the first three of the `width` columns of a variable."""

    variable: str
    width: int

    def at(self, nodes: Sequence[int] | Index) -> Slot:
        """Position of each of the nodes."""
        return Slot(self.variable, rows(self.variable, self.width, nodes).index[:, :3])


def at_nodes(race: Race, place: Place, nodes: Sequence[int], goals: Sequence[Gate]) -> Block:
    """Impose each gate at its node."""
    position, gate = ca.SX.sym("position", 3), ca.SX.sym("gate", 4)
    function = ca.Function("gate", [position, gate, ca.SX.sym("sigma")], [_outside(position, gate)])
    none = np.zeros((len(nodes), 1))
    return Block("gates", function, (place.at(nodes),), _numbers(race, goals), none - np.inf, none, "1")


def by_progress(race: Race, place: Place, intervals: int) -> Mpcc:
    """Let progress variables kappa (N + 1, gates) say where the gates are passed; the end is not among them."""
    gates = len(race.goals) - 1
    low, high = (np.full((intervals + 1, gates), bound) for bound in (0.0, 1.0))
    low[0], high[-1] = 1.0, 0.0
    kappa = Variable("kappa", low, high, np.linspace(high[0], low[-1], intervals + 1), "1", True)
    radii = np.array([goal.radius for goal in race.goals[:-1]])
    pairs = tuple(_pair(race, place, intervals, np.flatnonzero(radii == r)) for r in np.unique(radii))
    return Mpcc((kappa,), (_progress(intervals, gates), _order(intervals, gates)), (), pairs)


def passed_at(intervals: int, nodes: Sequence[int]) -> Array:
    """Progress kappa (N + 1, gates) of flights that pass each gate at one node."""
    return np.where(np.arange(intervals + 1)[:, None] <= np.asarray(nodes), 1.0, 0.0)


def _outside(position: ca.SX, gate: ca.SX) -> ca.SX:
    """Return h of a gate [w, r]."""
    return ca.sumsqr(position - gate[:3]) / gate[3] ** 2 - 1


def _numbers(race: Race, goals: Sequence[Gate]) -> Array:
    """[w, r] of each gate as the planner keeps it, (gates, 4) m."""
    return np.array([[*goal.position, goal.radius * (1 - race.gate_margin)] for goal in goals])


def _pair(race: Race, place: Place, intervals: int, which: Index) -> Pair:
    """Vanishing pairs mu, h at all nodes but the last, of those gates (columns of kappa) that share a radius."""
    nodes = np.repeat(np.arange(intervals), len(which))
    column = np.tile(which, intervals)
    kappa, position, gate = ca.SX.sym("kappa", 2), ca.SX.sym("position", 3), ca.SX.sym("gate", 4)
    out = ca.vertcat(kappa[0] - kappa[1], _outside(position, gate))
    function = ca.Function("gate_progress", [ca.vertcat(kappa, position), gate, ca.SX.sym("sigma")], [out])
    now = nodes * (len(race.goals) - 1) + column
    slots = (_two(now, now + len(race.goals) - 1), place.at(nodes))
    gates, none = _numbers(race, [race.goals[i] for i in column]), np.zeros((len(nodes), 2))
    block = Block("position", function, slots, gates, none, none, "m")
    return Pair(block, "vanishing", (float(gates[0, 3]),), sign_known=True)


def _progress(intervals: int, gates: int) -> Block:
    """Bound mu by 0 and 1."""
    k = np.arange(intervals * gates)
    return _difference("progress", k, k + gates)


def _order(intervals: int, gates: int) -> Block:
    """Bound kappa^{i+1} - kappa^i by 0 and 1 between the ends."""
    k = np.arange((intervals + 1) * gates).reshape(-1, gates)[1:-1, :-1].ravel()
    return _difference("gate_order", k + 1, k)


def _difference(name: str, left: Index, right: Index) -> Block:
    """Bound kappa[left] - kappa[right], flat positions, by 0 and 1."""
    z, none = ca.SX.sym("z", 2), np.zeros((len(left), 1))
    function = ca.Function("difference", [z, ca.SX.sym("p", 0), ca.SX.sym("sigma")], [z[0] - z[1]])
    return Block(name, function, (_two(left, right),), none[:, :0], none, none + 1, "1")


def _two(left: Index, right: Index) -> Slot:
    return Slot("kappa", np.stack([left, right], axis=1).astype(np.int64))
