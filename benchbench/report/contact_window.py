"""Where a plan claims to be in contact."""

from __future__ import annotations

import numpy as np

from benchbench.plan import Plan

CLAIM = 1e-3
"""Progress index above which a node claims contact, as in the certificate's limits; solvers leave tiny values
everywhere."""


def contact_windows(plan: Plan) -> list[tuple[int, int]]:
    """First and last node of every stretch of consecutive nodes that the plan claims to be in contact."""
    claimed = np.concatenate([[False], plan.progress > CLAIM, [False]])
    edges = np.flatnonzero(np.diff(claimed.astype(int)))
    return [(int(first), int(after) - 1) for first, after in edges.reshape(-1, 2)]
