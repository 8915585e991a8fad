"""Interface of a dynamics plugin: a transcription of continuous dynamics into variables and blocks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.model import LagrangianModel, Model, space
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.grid import Grid, Trajectory


class Dynamics(ABC):
    """A transcription: continuous dynamics and limits become variables and blocks."""

    needs_lagrangian: ClassVar[bool] = False
    """Variational integrators discretise the Lagrangian; a model without one is refused."""

    needs_vector_space: ClassVar[bool] = False
    """It adds configurations, so that dq/dt has to be v; a model on a manifold (quaternions) is refused."""

    def accepts(self, model: Model) -> bool:
        """Whether it can transcribe this model."""
        lacks = self.needs_lagrangian and not isinstance(model, LagrangianModel)
        return not (lacks or (self.needs_vector_space and not space(model).flat))

    @property
    @abstractmethod
    def order(self) -> int:
        """Order of convergence of nodal values for smooth inputs; measured by the conformance suite."""

    @abstractmethod
    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        """Return the dynamics, bounds, ends and cost of a scenario, and how to read its nodes."""
