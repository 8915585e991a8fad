"""A target that runs through timed points, for example a predicted path of a mobile robot."""

from __future__ import annotations

from pathlib import Path
from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.arrays import Array
from benchbench.errors import BadInput
from benchbench.ocp.motion import Motion
from benchbench.ocp.reading import content
from benchbench.ocp.sizes import CSV_BYTES, POINTS

FIELD = "scenario.target.csv"


@final
@dataclass(frozen=True)
class Spline(Motion):
    """Natural cubic spline through the rows `t,x,y,z` (s, m) of a CSV file with that header.

    Before the first and after the last time the target goes on in a straight line.
    """

    csv: Path

    @property
    def points(self) -> Array:
        """The rows of the file, (n, 4); raises BadInput when the file is missing or malformed."""
        try:
            header, *lines = _text(self.csv).splitlines() or [""]
            if [name.strip() for name in header.split(",")] != ["t", "x", "y", "z"]:
                raise BadInput(FIELD, f"has the header '{header[:40]}'", "t,x,y,z")
            table = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, 4))
        except ValueError as error:
            raise BadInput(FIELD, str(error), "numbers in four columns t,x,y,z") from None
        if table.shape[1] != 4 or len(table) < 3 or not np.all(np.isfinite(table)):
            raise BadInput(FIELD, f"has shape {table.shape}", "at least 3 rows of finite t,x,y,z")
        if len(table) > POINTS:
            raise BadInput(FIELD, f"has {len(table)} rows", f"at most {POINTS}")
        if np.any(np.diff(table[:, 0]) <= 0):
            raise BadInput(FIELD, "times do not increase", "strictly increasing t")
        return table

    @property
    def parameters(self) -> Array:
        """Per piece: start time, then a + b s + c s^2 + d s^3 for x, y, z with s = t - start; (pieces, 13)."""
        from scipy.interpolate import CubicSpline  # a third of a second, which no other motion needs

        table = self.points
        spline = CubicSpline(table[:, 0], table[:, 1:], bc_type="natural")
        pieces = np.concatenate(
            [spline.x[:-1, None], spline.c[::-1].transpose(1, 0, 2).reshape(-1, 12)], axis=1
        )
        first = np.concatenate([[-1e9], table[0, 1:], spline.c[2, 0], np.zeros(6)])
        last = np.concatenate([[table[-1, 0]], table[-1, 1:], spline(table[-1, 0], 1), np.zeros(6)])
        return np.concatenate([np.array([first, *pieces, last]).ravel(), table[:1, 0]])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Piecewise cubic, twice continuously differentiable."""
        count = (parameters.shape[0] - 1) // 13
        pieces = ca.reshape(parameters[:-1], 13, count)
        result = self._piece(pieces[:, 0], time - parameters[-1])
        for i in range(1, count):
            here = self._piece(pieces[:, i], time - pieces[0, i])
            result = ca.if_else(time >= pieces[0, i], here, result)
        return result

    @staticmethod
    def _piece(numbers: ca.SX, s: ca.SX) -> ca.SX:
        a, b, c, d = (numbers[1 + 3 * i : 4 + 3 * i] for i in range(4))
        return a + s * (b + s * (c + s * d))


def _text(path: Path) -> str:
    return content(path, FIELD, CSV_BYTES, "a CSV file with the header t,x,y,z").decode("utf-8-sig")
