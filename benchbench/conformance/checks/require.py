"""How a check fails: an AssertionError that `python -O` does not remove."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def require(holds: bool | np.bool_, message: str) -> None:
    """Raise AssertionError with `message` unless `holds`."""
    if not holds:
        raise AssertionError(message)


def close(got: ArrayLike, wanted: ArrayLike, tolerance: float, what: str) -> None:
    """Raise AssertionError unless |got - wanted| <= tolerance (1 + |wanted|) everywhere; NaN fails."""
    got, wanted = np.asarray(got, float), np.asarray(wanted, float)
    require(got.shape == wanted.shape, f"{what}: shape {got.shape}, expected {wanted.shape}")
    error = np.abs(got - wanted) / (1 + np.abs(wanted))
    worst = float(np.max(error, initial=0.0)) if np.all(np.isfinite(error)) else np.inf
    require(worst <= tolerance, f"{what}: relative error {worst:.2e}, allowed {tolerance:.0e}")
