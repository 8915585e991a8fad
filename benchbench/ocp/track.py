"""A race track: gates in the order they are passed, balls or rectangles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

Triple = tuple[float, float, float]
Direction = Literal["along", "against", "either"]


@dataclass(frozen=True)
class Opening:
    """A rectangle in the plane across `normal` (a unit vector): width along the horizontal, height across it, m.

    direction: flown "along" the normal, "against" it, or "either".
    """

    normal: Triple
    width: float
    height: float
    direction: Direction = "along"

    @property
    def sides(self) -> tuple[Triple, Triple]:
        """Unit vectors along the width and the height; of a horizontal opening x and the other."""
        n = np.array(self.normal)
        side = np.cross([0.0, 0.0, 1.0], n)
        length = float(np.linalg.norm(side))
        side = side / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])
        return triple(side), triple(np.cross(n, side))


@dataclass(frozen=True)
class Gate:
    """To be passed through: a ball about `position`, or the rectangle `opening` there.

    radius   of the ball, or of the smallest ball that holds the rectangle, m
    speed    least and largest speed in passing, m/s
    heading  direction of the nose over ground in passing, from the x axis, rad; kept to `HEADING`
    """

    position: Triple
    radius: float
    opening: Opening | None = None
    speed: tuple[float, float] | None = None
    heading: float | None = None

    @property
    def corners(self) -> tuple[Triple, ...]:
        """Corners of its rectangle in order, m; none of a ball."""
        if self.opening is None:
            return ()
        side, up = (np.array(axis) for axis in self.opening.sides)
        a, b = self.opening.width / 2 * side, self.opening.height / 2 * up
        return tuple(
            triple(np.array(self.position) + i * a + j * b) for i, j in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        )


HEADING = 0.1
"""By how much the nose may be off a gate's heading, rad; as in the handover (paper Table I)."""
EXACT = 0.02
"""Half the range of speeds, m/s, that a single speed stands for."""


@dataclass(frozen=True)
class Track:
    """Gates of one lap in order; start and end (x, y, z) in m and the number of gates where a file names them."""

    lap: tuple[Gate, ...]
    start: Triple | None = None
    end: Triple | None = None
    gates: int | None = None


def triple(values: Any) -> Triple:
    """Return three numbers as a tuple."""
    x, y, z = map(float, values)
    return x, y, z
