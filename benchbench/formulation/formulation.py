"""What is formulated as one MPCC: the part of a case that this room reads."""

from __future__ import annotations

from dataclasses import dataclass

from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.dynamics import Dynamics


@dataclass(frozen=True, kw_only=True)
class Formulation:
    """A task, the vehicle that flies it, and the transcription of its dynamics."""

    scenario: Scenario
    model: Model
    dynamics: Dynamics
