"""Gates as lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.track import Gate


def outlines(gates: Sequence[Gate]) -> dict[str, Array]:
    """Outline (n, 3) m of each gate and the end, by its numbers: "1, 8" where the lap is flown twice, "end"."""
    names: dict[Gate, list[str]] = {}
    for number, gate in enumerate(gates, 1):
        names.setdefault(gate, []).append("end" if number == len(gates) else str(number))
    return {", ".join(numbers): outline(gate) for gate, numbers in names.items()}


def outline(gate: Gate) -> Array:
    """Return the rectangle of a gate, or three great circles of its ball with gaps between them."""
    if gate.opening is not None:
        return np.array([*gate.corners, gate.corners[0]])
    angle = np.linspace(0.0, 2 * np.pi, 25)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
    circles = [np.vstack([np.roll(circle, turn, axis=1), np.full(3, np.nan)]) for turn in range(3)]
    return np.asarray(np.array(gate.position) + gate.radius * np.concatenate(circles))
