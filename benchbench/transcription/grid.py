"""The time axis of a transcription, and how to read a trajectory on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Slot
from benchbench.ocp.node import Node
from benchbench.ocp.plan import Plan

Mesh = Mapping[str, Sequence[float]]
"""Intervals of unequal length: shares of each phase's duration, by the name of the phase. Empty: equal steps."""


@dataclass(frozen=True)
class Phase:
    """A stretch of the time axis; its duration (s) is bounded and may be free.

    shares  of the duration that each interval has, (intervals,), 1 in sum; empty: equal steps
    """

    name: str
    intervals: int
    lower: float
    upper: float
    guess: float
    shares: tuple[float, ...] = ()

    @property
    def steps(self) -> Array:
        """Share of the duration that each interval has, (intervals,)."""
        return np.array(self.shares) if self.shares else np.full(self.intervals, 1.0 / self.intervals)

    def on(self, mesh: Mesh) -> Phase:
        """Return the phase with the intervals that a mesh has for it; as it is where the mesh says nothing of it."""
        shares = mesh.get(self.name, ())
        return replace(self, intervals=len(shares), shares=tuple(shares)) if shares else self


@dataclass(frozen=True)
class Grid:
    """The time axis as consecutive phases; one phase of equal steps is the paper's single free step size."""

    phases: tuple[Phase, ...]

    @property
    def intervals(self) -> int:
        """Total number of intervals N."""
        return sum(p.intervals for p in self.phases)

    @cached_property
    def step_weights(self) -> Array:
        """W (N, phases): interval k has the step h_k = W[k] @ durations, in s."""
        unit = np.eye(len(self.phases))
        return np.concatenate([np.outer(p.steps, unit[i]) for i, p in enumerate(self.phases)])

    @cached_property
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

    def encode(self, plan: Plan, durations: Array | None = None) -> dict[str, Array]:
        """Turn any plan into guesses for the unknowns, sampled at this grid's nodes.

        durations: of the phases (phases,), s; without them the plan's travel time is spread over them as they are guessed.
        """
