"""Where a plan claims to be in contact."""

from __future__ import annotations

import numpy as np

from benchbench.ocp.plan import Plan

CLAIM = 1e-3
"""Progress index above which a node claims contact, as in the certificate's limits; solvers leave tiny values
everywhere."""


def contact_windows(plan: Plan) -> list[tuple[int, int]]:
    """First and last node of every stretch of consecutive nodes that the plan claims to be in contact."""
    return [(first, last) for _, first, last in stop_windows(plan)]


def stop_windows(plan: Plan) -> list[tuple[int, int, int]]:
    """Column in `plan.progress_by_stop` of the stop, first and last node of every such stretch, in order of time."""
    found = []
    for stop, progress in enumerate(plan.progress_by_stop.T):
        claimed = np.concatenate([[False], progress > CLAIM, [False]])
        edges = np.flatnonzero(np.diff(claimed.astype(int)))
        found += [(stop, int(first), int(after) - 1) for first, after in edges.reshape(-1, 2)]
    return sorted(found, key=lambda window: window[1:])
