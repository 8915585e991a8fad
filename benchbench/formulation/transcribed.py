"""What every kind of scenario is posed on: the dynamics on a grid, and the obstacles that stand in the room."""

from __future__ import annotations

from benchbench.formulation.coupling import Coupling
from benchbench.formulation.formulation import Formulation
from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.motion import Nowhere
from benchbench.transcription.grid import Grid, Trajectory


def transcribed(case: Formulation, grid: Grid) -> tuple[Mpcc, Trajectory]:
    """Return dynamics, limits, ends, costs and obstacles of a case, and how to read its nodes."""
    scenario = case.scenario
    base, trajectory = case.dynamics.transcribe(scenario, case.model, grid)
    if not scenario.obstacles:
        return base, trajectory
    standing = Coupling(scenario.obstacles, case.model, Nowhere(), trajectory, prefix="obstacle_")
    return base + standing.always(), trajectory
