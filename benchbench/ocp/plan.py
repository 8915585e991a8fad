"""A plan: the decoded numbers of a trajectory, with names and units, free of any solver."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.columns import NODE, TIME, input_columns, progress_columns, velocity_columns
from benchbench.ocp.model import Model

if TYPE_CHECKING:
    import pandas as pd

Interpolation = Literal["hold", "linear", "bezier"]
ONLY = ("target",)
"""Name of the only column of the progress, where there are not several stops to tell apart."""


@dataclass(frozen=True)
class Plan:
    """What the vehicle is asked to do, node by node.

    With N intervals and N + 1 nodes:

    time           (N+1,) s, increasing, starts at 0
    configuration  (N+1, n_q) generalised coordinates q in `coordinate_units`
    velocity       (N+1, n_v) nodal velocities; dq/dt, unless `velocity_names` say otherwise
    inputs         (N, n_u) when `interpolation` is "hold" (row k acts on [t_k, t_{k+1}));
                   (N+1, n_u) when it is "linear" (row k is the value at t_k);
                   (N d, n_u) when it is "bezier": d control points per interval, a polynomial of degree
                   d - 1 in each, which stays within the bounds of its control points
    progress       (N+1,), or (N+1, stops) where there are several: progress index epsilon_k in [0, 1] at each
                   node (last entry 0 for DMCC plans); epsilon_k > 0 claims that node k is in contact; NaN
                   throughout: the plan says nothing of contact
    stop_names     names of the stops, in the order of the columns of `progress`
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
    velocity_names: tuple[str, ...] = ()
    velocity_units: tuple[str, ...] = ()
    stop_names: tuple[str, ...] = ONLY

    def __post_init__(self) -> None:
        """Check the shapes against each other; raises ValueError naming the wrong one."""
        if not self.velocity_names:
            object.__setattr__(self, "velocity_names", self.coordinate_names)
            object.__setattr__(self, "velocity_units", tuple(f"{unit}/s" for unit in self.coordinate_units))
        nodes = len(self.time)
        if self.progress.shape == (nodes, 1):
            object.__setattr__(self, "progress", self.progress[:, 0])
        rows = {"hold": nodes - 1, "linear": nodes}.get(self.interpolation, len(self.inputs))
        if rows % (nodes - 1) and self.interpolation == "bezier":
            raise ValueError(f"plan.inputs has {rows} control points for {nodes - 1} intervals")
        wanted = {
            "configuration": (nodes, len(self.coordinate_names)),
            "velocity": (nodes, len(self.velocity_names)),
            "inputs": (rows, len(self.input_names)),
            "progress": (nodes,) if len(self.stop_names) == 1 else (nodes, len(self.stop_names)),
        }
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"plan.{name} has shape {getattr(self, name).shape}, expected {shape}")

    @classmethod
    def of(
        cls,
        model: Model,
        *,
        time: Array,
        configuration: Array,
        velocity: Array,
        inputs: Array,
        progress: Array,
        interpolation: Interpolation = "hold",
        stop_names: tuple[str, ...] = ONLY,
    ) -> Plan:
        """Return the plan of a model, with its names and units."""
        q, v, u = model.configuration, model.velocity, model.inputs
        return cls(
            time=time, configuration=configuration, velocity=velocity, inputs=inputs, progress=progress,
            interpolation=interpolation, coordinate_names=q.names, coordinate_units=q.units, input_names=u.names,
            input_units=u.units, velocity_names=v.names, velocity_units=v.units, stop_names=stop_names,
        )  # fmt: skip

    @property
    def intervals(self) -> int:
        """Number of intervals N."""
        return len(self.time) - 1

    @property
    def progress_by_stop(self) -> Array:
        """Progress index of each node for each stop, (N + 1, stops), also where there is one stop."""
        return self.progress.reshape(len(self.time), -1)

    @property
    def travel_time(self) -> float:
        """Travel time t_N in seconds."""
        return float(self.time[-1])

    def contact(self, stop: int = 0) -> tuple[int, int] | None:
        """First and last node of the first run of nodes that claim contact with a stop by more than half a step.

        None where the plan claims none.
        """
        claimed = np.flatnonzero(self.progress_by_stop[:, stop] > 0.5)
        if not len(claimed):
            return None
        gaps = np.flatnonzero(np.diff(claimed) > 1)
        return int(claimed[0]), int(claimed[gaps[0]] if len(gaps) else claimed[-1])

    @property
    def contacts(self) -> tuple[tuple[int, int], ...]:
        """The first claimed contact with each stop, in order of time; stops without one are left out."""
        found = (self.contact(stop) for stop in range(self.progress_by_stop.shape[1]))
        return tuple(sorted(one for one in found if one is not None))

    @property
    def input_pieces(self) -> Array:
        """Control points of the input in each interval, shape (N, d, n_u); d = 1 is held, d = 2 linear."""
        if self.interpolation == "linear":
            return np.stack([self.inputs[:-1], self.inputs[1:]], axis=1)
        return self.inputs.reshape(self.intervals, -1, len(self.input_names))

    @property
    def input_times(self) -> Array:
        """Times to show the rows of `inputs` at, one for each, in s."""
        if self.interpolation == "linear":
            return self.time
        count = len(self.inputs) // self.intervals
        share = np.linspace(0.0, 1.0, count) if count > 1 else np.zeros(1)
        return np.asarray(self.time[:-1, None] + np.diff(self.time)[:, None] * share).ravel()

    def input_at(self, time: Array) -> Array:
        """Return the inputs at the given times, shape (len(time), n_u), interpolated as declared."""
        k = np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, self.intervals - 1)
        share = np.clip((time - self.time[k]) / np.diff(self.time)[k], 0.0, 1.0)
        return bezier(self.input_pieces[k], share)

    def to_frame(self) -> pd.DataFrame:
        """Return the plan as a table, one row per node, SI units and rad; `frame.attrs["units"]` names each.

        time                 s
        coordinates          by their names, in `coordinate_units`
        velocities           by their names, in `velocity_units`; v_x, v_roll, ... where those are the coordinates'
        inputs               by their names, in `input_units`, as they are at the node: held until the next ("hold"), on
                             a line to the next ("linear"), the first control point of a polynomial ("bezier", whose
                             others are motor_1.1, motor_1.2, ...). Only "linear" has inputs in the last row
        progress             progress index, 1; progress_NAME for each stop where there are several
        """
        import pandas as pd  # half a second, which plans that nobody looks at need not take

        pieces = self.input_pieces if self.interpolation == "bezier" else self.inputs[:, None, :]
        inputs = np.full((len(self.time), *pieces.shape[1:]), np.nan)
        inputs[: len(pieces)] = pieces
        points = pieces.shape[1]
        names = [
            TIME, *self.coordinate_names, *velocity_columns(self.coordinate_names, self.velocity_names),
            *input_columns(self.input_names, points), *progress_columns(self.stop_names),
        ]  # fmt: skip
        units = [
            "s", *self.coordinate_units, *self.velocity_units, *self.input_units * points, *["1"] * len(self.stop_names)
        ]  # fmt: skip
        flat = inputs.reshape(len(self.time), -1)
        values = np.column_stack([self.time, self.configuration, self.velocity, flat, self.progress_by_stop])
        frame = pd.DataFrame(values, columns=names).rename_axis(NODE)
        frame.attrs["units"] = dict(zip(names, units, strict=True))
        return frame


def bernstein(count: int, s: Any) -> list[Any]:
    """Return the `count` Bernstein polynomials of degree count - 1 at s in [0, 1], numbers or symbols."""
    return [comb(count - 1, j) * s**j * (1 - s) ** (count - 1 - j) for j in range(count)]


def bezier(points: Array, s: Array | float) -> Array:
    """Values (..., n) of Bezier curves with control points (..., d, n) at s (...,) in [0, 1]."""
    fraction = np.asarray(s, float)[..., None, None]
    here = points * np.ones_like(fraction)
    while here.shape[-2] > 1:  # de Casteljau's algorithm
        here = here[..., :-1, :] + fraction * (here[..., 1:, :] - here[..., :-1, :])
    return np.asarray(here[..., 0, :])
