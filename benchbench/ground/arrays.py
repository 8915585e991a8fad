"""The arrays that everything is made of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Numbers."""
Index = NDArray[np.int64]
"""Positions in an array."""
Flags = NDArray[np.bool_]
"""True or false for each entry of an array."""
