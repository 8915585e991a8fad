"""What every kind of scenario is posed on: the dynamics on a grid, forces of contact, and the obstacles that stand in the room."""

from __future__ import annotations

import casadi as ca

from benchbench.formulation.coupling import Coupling
from benchbench.formulation.formulation import Formulation
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Mpcc, Pair, block, rows
from benchbench.ocp.motion import Nowhere
from benchbench.ocp.touching import TouchingModel
from benchbench.transcription.grid import Grid, Trajectory


def transcribed(case: Formulation, grid: Grid) -> tuple[Mpcc, Trajectory]:
    """Return dynamics, limits, ends, costs, contact forces and obstacles of a case, and how to read its nodes."""
    scenario = case.scenario
    base, trajectory = case.dynamics.transcribe(scenario, case.model, grid)
    base += _touching(case, base, trajectory)
    if not scenario.obstacles:
        return base, trajectory
    standing = Coupling(scenario.obstacles, case.model, Nowhere(), trajectory, prefix="obstacle_")
    return base + standing.always(), trajectory


def _touching(case: Formulation, base: Mpcc, trajectory: Trajectory) -> Mpcc:
    """Complementarity of forces of contact at every node, where the vehicle has such."""
    model, nodes = case.model, range(trajectory.grid.intervals + 1)
    if not isinstance(model, TouchingModel):
        return Mpcc()
    inputs = next(variable for variable in base.variables if variable.name == "u")
    if len(inputs.guess) != len(nodes):
        problem = f"has no inputs at its nodes, where {' and '.join(model.touches)} of the vehicle is found"
        allowed = "dynamics.inputs=linear (trapezoidal, hermite_simpson) or averaged (verlet)"
        raise IncompatibleCase("dynamics", problem, allowed)
    sizes = {
        "q": len(model.configuration.names),
        "v": len(model.velocity.names),
        "u": len(model.inputs.names),
    }
    slots = [rows(name, size, nodes) for name, size in sizes.items()]
    return Mpcc(
        pairs=(Pair(block("touching", slots, lambda *z: ca.vertcat(*model.contact(*z))), "complementarity"),)
    )
