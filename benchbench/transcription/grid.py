"""The time axis of a transcription, and how to read a trajectory on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from benchbench.arrays import Array
from benchbench.mpcc.problem import Slot
from benchbench.ocp.node import Node
from benchbench.ocp.plan import Plan


@dataclass(frozen=True)
class Phase:
    """A stretch of the time axis with equal steps; its duration (s) is bounded and may be free."""

    name: str
    intervals: int
    lower: float
    upper: float
    guess: float


@dataclass(frozen=True)
class Grid:
    """The time axis as consecutive phases; one phase is the paper's single free step size."""

    phases: tuple[Phase, ...]

    @property
    def intervals(self) -> int:
        """Total number of intervals N."""
        return sum(p.intervals for p in self.phases)

    @property
    def step_weights(self) -> Array:
        """W (N, phases): interval k has the step h_k = W[k] @ durations, in s."""
        return np.concatenate(
            [
                np.tile(np.eye(len(self.phases))[i] / p.intervals, (p.intervals, 1))
                for i, p in enumerate(self.phases)
            ]
        )

    @property
    def time_weights(self) -> Array:
        """W (N + 1, phases): node k is at t_k = W[k] @ durations, in s."""
        return np.concatenate([np.zeros((1, len(self.phases))), np.cumsum(self.step_weights, axis=0)])

    @property
    def ends(self) -> tuple[int, ...]:
        """Last node of each phase."""
        return tuple(int(k) for k in np.cumsum([p.intervals for p in self.phases]))

    def nodes(self, name: str) -> range:
        """All nodes of one phase, both ends included."""
        first = 0
        for phase in self.phases:
            if phase.name == name:
                return range(first, first + phase.intervals + 1)
            first += phase.intervals
        raise KeyError(name)


class Trajectory(Protocol):
    """How to read a transcription without knowing it; contacts and guesses use nothing else."""

    @property
    def grid(self) -> Grid:
        """The time axis."""

    @property
    def node(self) -> Node:
        """The expressions of a node, the same for every node."""

    def slots(self, nodes: Sequence[int]) -> tuple[Slot, ...]:
        """Where the unknowns z of the given nodes are, in the order of `node.z`."""

    def parameters(self, nodes: Sequence[int]) -> Array:
        """The numbers p of the given nodes, shape (nodes, n_p)."""

    def decode(self, values: dict[str, Array], progress: Array) -> Plan:
        """Turn named values of the unknowns into a plan."""

    def encode(self, plan: Plan) -> dict[str, Array]:
        """Turn any plan into guesses for the unknowns: sampled at equal fractions of each phase."""
