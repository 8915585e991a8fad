"""A plan: the decoded numbers of a trajectory, with names and units, free of any solver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Interpolation = Literal["hold", "linear"]


@dataclass(frozen=True)
class Plan:
    """What the vehicle is asked to do, node by node.

    With N intervals and N + 1 nodes:

    time           (N+1,) s, increasing, starts at 0
    configuration  (N+1, n_q) generalised coordinates q in `coordinate_units`
    velocity       (N+1, n_q) nodal velocities dq/dt, per second
    inputs         (N, n_u) when `interpolation` is "hold" (row k acts on [t_k, t_{k+1}));
                   (N+1, n_u) when it is "linear" (row k is the value at t_k)
    progress       (N+1,) progress index epsilon_k in [0, 1] at each node (last entry 0 for DMCC plans);
                   epsilon_k > 0 claims that node k is in contact
    """

    time: Array
    configuration: Array
    velocity: Array
    inputs: Array
    progress: Array
    interpolation: Interpolation
    coordinate_names: tuple[str, ...]
    coordinate_units: tuple[str, ...]
    input_names: tuple[str, ...]
    input_units: tuple[str, ...]

    def __post_init__(self) -> None:
        """Check the shapes against each other; raises ValueError naming the wrong one."""
        nodes, rows = len(self.time), len(self.time) - (self.interpolation == "hold")
        wanted = {
            "configuration": (nodes, len(self.coordinate_names)),
            "velocity": (nodes, len(self.coordinate_names)),
            "inputs": (rows, len(self.input_names)),
            "progress": (nodes,),
        }
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"plan.{name} has shape {getattr(self, name).shape}, expected {shape}")

    @property
    def intervals(self) -> int:
        """Number of intervals N."""
        return len(self.time) - 1

    @property
    def travel_time(self) -> float:
        """Travel time t_N in seconds."""
        return float(self.time[-1])

    def input_at(self, time: Array) -> Array:
        """Return the inputs at the given times, shape (len(time), n_u), interpolated as declared."""
        if self.interpolation == "hold":
            row = np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, self.intervals - 1)
            return np.asarray(self.inputs[row])
        return np.stack([np.interp(time, self.time, column) for column in self.inputs.T], axis=-1)
