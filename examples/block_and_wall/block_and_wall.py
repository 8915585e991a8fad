"""A block is pushed along a rough floor, with least effort, until it meets a wall hard enough and rests."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import ReadyMade, whole


@dataclass(frozen=True)
class BlockAndWall(ReadyMade):
    """1 kg, start to wall `way` m, friction `friction` N, N steps in `time` s (Stewart & Trinkle 1996); `press` N is the wall's mean force in the last step."""

    way: float
    friction: float
    press: float
    time: float
    intervals: int

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "block_and_wall"

    def mpcc(self) -> Mpcc:
        """Unknowns per step, (N,) each: place x, speed v, push u, wall force c, friction forward a and backward b, slip s."""
        n, h = self.intervals, self.time / self.intervals
        x, v, u, c, a, b, s = unknowns = [ca.SX.sym(letter, n) for letter in "xvucabs"]
        w, before = ca.vertcat(*unknowns), lambda z: ca.vertcat(0, z[:-1])
        motion = ca.vertcat(v - before(v) - h * (u - c + a - b), x - before(x) - h * v)
        values = {
            "f": h * ca.sumsqr(u), "g": ca.vertcat(motion, v[-1], c[-1]),
            "G": ca.vertcat(self.way - x, a, b, s), "H": ca.vertcat(c, s + v, s - v, self.friction - a - b),
        }  # fmt: skip
        functions = {key: ca.Function(key, [w, ca.SX.sym("p", 0)], [value]) for key, value in values.items()}
        zero, free = np.zeros(2 * n + 1), np.full(7 * n, np.inf)
        low, high = np.append(zero, self.press), np.append(zero, np.inf)
        return whole(functions, np.zeros(0), np.full(7 * n, 0.1), (-free, free), (low, high))
