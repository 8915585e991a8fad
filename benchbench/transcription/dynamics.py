"""Interface of a dynamics plugin (a transcription) and the values it speaks: grid, node view, trajectory."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Protocol

import casadi as ca
import numpy as np

from benchbench.mpcc.problem import Mpcc, Slot
from benchbench.ocp.plan import Array, Plan

if TYPE_CHECKING:
    from benchbench.ocp.model import Model
    from benchbench.ocp.scenario import Scenario


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


@dataclass(frozen=True)
class Node:
    """What can be said about one node: expressions of its local unknowns z and parameters p (SX)."""

    z: ca.SX
    p: ca.SX
    time: ca.SX
    configuration: ca.SX
    velocity: ca.SX


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


class Dynamics(ABC):
    """A transcription: continuous dynamics and limits become variables and blocks."""

    needs_lagrangian: ClassVar[bool] = False
    """Variational integrators discretise the Lagrangian; a model without one is refused."""

    needs_vector_space: ClassVar[bool] = False
    """It adds configurations, so that dq/dt has to be v; a model on a manifold (quaternions) is refused."""

    def accepts(self, model: Model) -> bool:
        """Whether it can transcribe this model."""
        lacks = self.needs_lagrangian and not model.has_lagrangian
        return not (lacks or (self.needs_vector_space and model.has_quasi_velocities))

    @property
    @abstractmethod
    def order(self) -> int:
        """Order of convergence of nodal values for smooth inputs; measured by the conformance suite."""

    @abstractmethod
    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return the dynamics, bounds, ends and cost of a scenario, and how to read its nodes."""
