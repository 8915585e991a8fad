"""What a case is posed as: an MPCC and how to read a plan out of its unknowns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from benchbench.formulation.coupling import progress_index
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.plan import ONLY, Plan
from benchbench.transcription.grid import Trajectory

NodesByStop = Mapping[str, tuple[int, ...]]
"""Nodes at which progress is made (in contact, or through a gate) by the name of the stop."""


@dataclass(frozen=True)
class Problem:
    """An MPCC and how to read its unknowns.

    contact   nodes at which progress is made, by stop, when they are fixed; None: the progress variables tell
    progress  name of the progress variable of each column of a plan's progress, by the column's name
    """

    mpcc: Mpcc
    trajectory: Trajectory
    contact: NodesByStop | None
    progress: Mapping[str, str] = field(default_factory=dict)

    def decode(self, values: dict[str, Array]) -> Plan:
        """Turn named values into a plan with its progress index for every stop."""
        columns = self.progress or dict.fromkeys(ONLY, "kappa")
        plan = self.trajectory.decode(values, np.zeros(self.trajectory.grid.intervals + 1))
        told = [self._progress(name, kappa, values) for name, kappa in columns.items()]
        return replace(plan, progress=np.stack(told, axis=-1), stop_names=tuple(columns))

    def _progress(self, name: str, kappa: str, values: dict[str, Array]) -> Array:
        if self.contact is None:
            return progress_index(values[kappa])
        progress = np.zeros(self.trajectory.grid.intervals + 1)
        progress[list(self.contact.get(name, ()))] = 1.0
        return progress
