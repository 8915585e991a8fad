"""Inertias that a rigid body can have: no principal moment exceeds the sum of the other two."""

from __future__ import annotations

import numpy as np

from benchbench.ground.arrays import Array


def rigid(moments: Array) -> Array:
    """Return the principal moments (3,) kg m^2 nearest to the given ones, by least squares, that some rigid body has.

    The largest is lowered and the others are raised by a third of what is missing; the paper's own are not of this kind.
    """
    largest = int(np.argmax(moments))
    missing = max(2 * moments[largest] - moments.sum(), 0.0)
    return np.asarray(moments + missing / 3 * np.where(np.arange(3) == largest, -1.0, 1.0))
