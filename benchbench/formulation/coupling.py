"""The two ways to impose the conditions of a contact on a trajectory.

A contact only says *what* must hold. *When* it must hold is a separate choice: `by_progress` leaves it to the optimiser
(the paper's progress variables and complementarity), `at_nodes` imposes it on chosen nodes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from benchbench.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, Variable, rows
from benchbench.ocp.contact import Condition, Contacts, Target
from benchbench.ocp.model import Model
from benchbench.ocp.motion import Motion, motion_state
from benchbench.transcription.grid import Trajectory


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
        there is a contact, kappa_0 is free.
        """
        n = self.trajectory.grid.intervals
        fixed = np.full((n + 1, 1), np.nan)
        fixed[0], fixed[-1] = kappa_init if decided else np.nan, 0.0
        free = np.isnan(fixed)
        guess = np.linspace(kappa_init, 0.0, n + 1)[:, None]
        kappa = Variable(
            self.kappa, np.where(free, 0.0, fixed), np.where(free, float(kappa_init), fixed), guess, "1", True
        )
        z, p, s = ca.SX.sym("z", 2), ca.SX.sym("p", 0), ca.SX.sym("sigma")
        nodes = range(n)
        step = (rows(self.kappa, 1, nodes), rows(self.kappa, 1, range(1, n + 1)))
        progress = Block(
            f"{self.prefix}progress", ca.Function("progress", [z, p, s], [z[0] - z[1]]), step,
            np.zeros((n, 0)), np.zeros((n, 1)), np.ones((n, 1)), "1",
        )  # fmt: skip
        pairs = []
        for name, condition, block in self._blocks(nodes, always=False):
            inner = block.function
            w, q = ca.SX.sym("z", 2 + inner.size1_in(0)), ca.SX.sym("p", inner.size1_in(1))
            h = inner(w[2:], q, s)
            g = ca.repmat(w[0] - w[1], h.shape[0], 1)
            both = ca.Function(f"pair_{name}", [w, q, s], [ca.vertcat(g, h)])
            none = np.zeros((n, 2 * h.shape[0]))
            paired = Block(block.name, both, step + block.slots, block.parameters, none, none, condition.unit)
            pairs.append(Pair(paired, "vanishing", condition.limit, sign_known=True))
        return Mpcc((kappa,), (progress,), (), tuple(pairs)) + self.always()

    @property
    def kappa(self) -> str:
        """Name of the progress variable."""
        return f"{self.prefix}kappa"

    def at_nodes(self, nodes: Sequence[int]) -> Mpcc:
        """Impose every condition at the given nodes: no progress variables, no complementarity."""
        return Mpcc((), tuple(block for _, _, block in self._blocks(nodes, always=False))) + self.always()

    def always(self) -> Mpcc:
        """Impose the conditions that hold at every node, in contact or not."""
        nodes = range(self.trajectory.grid.intervals)
        return Mpcc((), tuple(block for _, _, block in self._blocks(nodes, always=True)))

    def _blocks(self, nodes: Sequence[int], always: bool) -> list[tuple[str, Condition, Block]]:
        node = self.trajectory.node
        p = ca.SX.sym("p", node.p.shape[0] + len(self.motion.parameters))
        position, velocity = motion_state(self.motion, node.time, p[node.p.shape[0] :])
        found = []
        for name, contact in self.contacts.items():
            if contact.always != always:
                continue
            condition = contact.condition(self.model, node, Target(position, velocity))
            condition = condition.tightened(self.margins.get(name, 0.0))
            h = ca.substitute(condition.h, node.p, p[: node.p.shape[0]])
            function = ca.Function(f"contact_{name}", [node.z, p, ca.SX.sym("sigma")], [h])
            m = len(nodes)
            numbers = np.hstack([self.trajectory.parameters(nodes), np.tile(self.motion.parameters, (m, 1))])
            shape = (m, h.shape[0])
            block = Block(
                f"{self.prefix}{name}", function, self.trajectory.slots(nodes), numbers,
                np.full(shape, -np.inf), np.zeros(shape), condition.unit,
            )  # fmt: skip
            found.append((name, condition, block))
        return found


def retargeted(block: Block, motion: Motion) -> Block:
    """A block of a contact with other numbers of the target's motion, which are its last parameters."""
    numbers = block.parameters.copy()
    numbers[:, numbers.shape[1] - len(motion.parameters) :] = motion.parameters
    return replace(block, parameters=numbers)


def progress_index(kappa: Array) -> Array:
    """Return epsilon (N + 1,) from kappa (N + 1, events), the largest of all; the last node gets 0 (paper Eq. 26)."""
    steps = -np.diff(np.reshape(kappa, (len(kappa), -1)), axis=0)
    return np.append(np.max(steps, axis=1), 0.0)
