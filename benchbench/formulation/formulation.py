"""What is formulated as one MPCC: the part of a case that this room reads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Mesh


@dataclass(frozen=True, kw_only=True)
class Formulation:
    """A task, the vehicle that flies it, and the transcription of its dynamics.

    mesh     intervals of unequal length, for problems posed as phases; empty: as many as the scenario says, of equal length
    resting  stops that are made once their target stands, by name: from when, s; where the nose points is then not asked
    """

    scenario: Scenario
    model: Model
    dynamics: Dynamics
    mesh: Mesh = field(default_factory=dict)
    resting: Mapping[str, float] = field(default_factory=dict)
