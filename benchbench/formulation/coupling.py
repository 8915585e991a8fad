"""The two ways to impose the conditions of a contact on a trajectory.

A contact only says *what* must hold. *When* it must hold is a separate choice: `by_progress` leaves it to the optimiser
(the paper's progress variables and complementarity), `at_nodes` imposes it on chosen nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, Slot, Variable, block, rows
from benchbench.ocp.contact import Condition, Contacts, Kept, Target
from benchbench.ocp.model import Model
from benchbench.ocp.motion import Motion, motion_state
from benchbench.transcription.grid import Trajectory

Share = Callable[..., tuple[ca.SX, tuple[ca.SX, ...]]]
"""From what a pair reads to its G, and what is left for its H."""


@dataclass(frozen=True)
class Coupling:
    """Contacts of one event, bound to a model, a target motion and a transcription.

    `margins` by contact name: share of the limit that the planner leaves unused. `prefix` of all names of
    variables and blocks tells several events apart.
    """

    contacts: Contacts
    model: Model
    motion: Motion
    trajectory: Trajectory
    margins: Mapping[str, float] = field(default_factory=dict)
    prefix: str = ""

    def by_progress(self, kappa_init: int, decided: bool = True) -> Mpcc:
        """Progress variables and vanishing pairs: epsilon_k > 0 only where every condition holds.

        kappa_0 = kappa_init, kappa_N = 0, epsilon_k = kappa_k - kappa_{k+1} in [0, 1] (paper Eq. 26);
        epsilon is substituted, so the only new unknowns are kappa (N + 1,). Where it is not `decided` that
        there is a contact, kappa_0 is free. What is kept until the contact is over vanishes with kappa_k.
        """
        n = self.trajectory.grid.intervals
        fixed = np.full((n + 1, 1), np.nan)
        fixed[0], fixed[-1] = kappa_init if decided else np.nan, 0.0
        free = np.isnan(fixed)
        guess = np.linspace(kappa_init, 0.0, n + 1)[:, None]
        kappa = Variable(
            self.kappa, np.where(free, 0.0, fixed), np.where(free, float(kappa_init), fixed), guess, "1", True
        )
        nodes = range(n)
        step = (rows(self.kappa, 1, nodes), rows(self.kappa, 1, range(1, n + 1)))
        progress = block(
            f"{self.prefix}progress",
            step,
            lambda now, then: now - then,
            upper=1.0,
            unit="1",
            function="progress",
        )
        now = (rows(self.kappa, 1, nodes),)
        pairs = (
            *self._pairs("in contact", step, _step),
            *self._pairs("until contact", now, partial(_left, kappa_init)),
        )
        return Mpcc((kappa,), (progress,), (), pairs) + self.always()

    def _pairs(self, kept: Kept, slots: tuple[Slot, ...], share: Share) -> Iterator[Pair]:
        """Vanishing pairs of the conditions that are kept so, at all nodes but the last; G is a `share` of what `slots` read."""
        for name, condition, imposed in self._blocks(range(self.trajectory.grid.intervals), kept):
            paired = block(
                imposed.name, slots + imposed.slots, partial(_pair, imposed.function, share), parameters=imposed.parameters,
                unit=condition.unit, function=f"pair_{name}",
            )  # fmt: skip
            yield Pair(paired, "vanishing", condition.limit, sign_known=True)

    @property
    def kappa(self) -> str:
        """Name of the progress variable."""
        return f"{self.prefix}kappa"

    def at_nodes(self, nodes: Sequence[int]) -> Mpcc:
        """Impose every condition at the given nodes: no progress variables, no complementarity."""
        until = range(max(nodes) + 1)
        found = [*self._blocks(nodes, "in contact"), *self._blocks(until, "until contact")]
        return Mpcc((), tuple(imposed for _, _, imposed in found)) + self.always()

    def always(self) -> Mpcc:
        """Impose the conditions that hold at every node, in contact or not."""
        nodes = range(self.trajectory.grid.intervals)
        return Mpcc((), tuple(imposed for _, _, imposed in self._blocks(nodes, "always")))

    def _blocks(self, nodes: Sequence[int], kept: Kept) -> list[tuple[str, Condition, Block]]:
        node = self.trajectory.node
        p = ca.SX.sym("p", node.p.shape[0] + len(self.motion.parameters))
        position, velocity = motion_state(self.motion, node.time, p[node.p.shape[0] :])
        found = []
        for name, contact in self.contacts.items():
            if contact.kept != kept:
                continue
            condition = contact.condition(self.model, node, Target(position, velocity))
            condition = condition.tightened(self.margins.get(name, 0.0))
            h = ca.substitute(condition.h, node.p, p[: node.p.shape[0]])
            function = ca.Function(f"contact_{name}", [node.z, p, ca.SX.sym("sigma")], [h])
            target = np.tile(self.motion.parameters, (len(nodes), 1))
            none = np.zeros((len(nodes), h.shape[0]))
            imposed = Block(
                f"{self.prefix}{name}", function, self.trajectory.slots(nodes),
                parameters=np.hstack([self.trajectory.parameters(nodes), target]),
                lower=none - np.inf, upper=none, unit=condition.unit,
            )  # fmt: skip
            found.append((name, condition, imposed))
        return found


def _step(now: ca.SX, then: ca.SX, *reads: ca.SX) -> tuple[ca.SX, tuple[ca.SX, ...]]:
    """G = kappa_k - kappa_{k+1}, the progress made at a node."""
    return now - then, reads


def _left(kappa_init: int, now: ca.SX, *reads: ca.SX) -> tuple[ca.SX, tuple[ca.SX, ...]]:
    """G = kappa_k / kappa_init, the share of the contact that is still to come at a node."""
    return now / kappa_init, reads


def _pair(condition: ca.Function, share: Share, *reads: ca.SX) -> ca.SX:
    """G, once for each row of the condition H."""
    g, (*z, p) = share(*reads)
    h = condition(ca.vertcat(*z), p, 0)
    return ca.vertcat(ca.repmat(g, h.shape[0], 1), h)


def retargeted(block: Block, motion: Motion) -> Block:
    """A block of a contact with other numbers of the target's motion, which are its last parameters."""
    numbers, moved = block.parameters.copy(), motion.parameters
    numbers[:, numbers.shape[1] - len(moved) :] = moved
    return replace(block, parameters=numbers)


def progress_index(kappa: Array) -> Array:
    """Return epsilon (N + 1,) from kappa (N + 1, events), the largest of all; the last node gets 0 (paper Eq. 26)."""
    steps = -np.diff(np.reshape(kappa, (len(kappa), -1)), axis=0)
    return np.append(np.max(steps, axis=1), 0.0)
