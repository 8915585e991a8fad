"""Values with their limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Coordinates


@dataclass(frozen=True, eq=False)
class Limited:
    """Values (rows, n), with a name and a unit each, and what they have to stay between, (n,) or (rows, n)."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    lower: Array
    upper: Array

    @classmethod
    def of(cls, box: Coordinates, values: Array, limits: tuple[Array, Array] | None = None) -> Limited:
        """Values (rows, n) of these coordinates within their limits, or within others of the same coordinates."""
        return cls(box.names, box.units, values, *(limits or (box.lower, box.upper)))

    def beside(self, other: Limited) -> Limited:
        """Return both, one after the other."""
        lower, upper = (
            np.hstack([np.broadcast_to(getattr(one, side), one.values.shape) for one in (self, other)])
            for side in ("lower", "upper")
        )
        values = np.hstack([self.values, other.values])
        return Limited((*self.names, *other.names), (*self.units, *other.units), values, lower, upper)

    @property
    def excess(self) -> Array:
        """How far each value is beyond its limits, (rows, n), 0 inside; NaN stays NaN."""
        return np.asarray(np.maximum(np.maximum(self.lower - self.values, self.values - self.upper), 0.0))

    @property
    def ratio(self) -> Array:
        """|value| over its limit, from the middle of the limits, (rows, n); 0 without limits; NaN stays NaN."""
        with np.errstate(invalid="ignore"):
            half, middle = (self.upper - self.lower) / 2, (self.upper + self.lower) / 2
            limited = np.isfinite(half)
            ratio = np.abs(self.values - np.where(limited, middle, 0.0)) / half
        return np.where(limited | np.isnan(self.values), ratio, 0.0)
