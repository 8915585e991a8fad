"""The yardstick of solve times: a fixed nonlinear program that uses nothing of BenchBench.

Its CPU time rises with the load and falls with the speed of the machine as ours does, so that the ratio of the
two stays. Never change it: every stored ratio refers to it.
"""

from __future__ import annotations

import time
from typing import Any

import casadi as ca

INTERVALS = 400


class Reference:
    """Time-optimal cart-pole swing-up by the trapezoidal rule, solved by IPOPT from one and the same point."""

    def __init__(self) -> None:
        """Build it once; building is not timed."""
        x, u, h = ca.SX.sym("x", 4, INTERVALS + 1), ca.SX.sym("u", INTERVALS + 1), ca.SX.sym("h")
        rates = ca.horzcat(*(_rates(x[:, k], u[k]) for k in range(INTERVALS + 1)))
        defects = x[:, 1:] - x[:, :-1] - h / 2 * (rates[:, 1:] + rates[:, :-1])
        ends = ca.vertcat(x[:, 0], x[:, -1] - ca.DM([0.0, ca.pi, 0.0, 0.0]))
        problem = {
            "x": ca.vertcat(h, u, ca.vec(x)),
            "f": INTERVALS * h + 1e-3 * h * ca.sumsqr(u),
            "g": ca.vertcat(ca.vec(defects), ends),
        }
        options: dict[str, Any] = {
            "ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False, "ipopt.max_iter": 60, "ipopt.tol": 1e-8,
        }  # fmt: skip
        self._solver = ca.nlpsol("reference", "ipopt", problem, options)
        lean = ca.vertcat(*(ca.DM([0.0, ca.pi * k / INTERVALS, 0.0, 0.0]) for k in range(INTERVALS + 1)))
        self._point = ca.vertcat(2.0 / INTERVALS, ca.DM.zeros(INTERVALS + 1), lean)
        size = self._point.numel() - INTERVALS - 2
        self._low = ca.vertcat(1e-4, -20.0 * ca.DM.ones(INTERVALS + 1), -50.0 * ca.DM.ones(size))
        self._high = ca.vertcat(0.05, 20.0 * ca.DM.ones(INTERVALS + 1), 50.0 * ca.DM.ones(size))

    def cpu_s(self) -> float:
        """Solve it and return the CPU time in s. Raises RuntimeError if it does not take its iterations."""
        began = time.process_time()
        self._solver(x0=self._point, lbx=self._low, ubx=self._high, lbg=0.0, ubg=0.0)
        spent = time.process_time() - began
        if self._solver.stats()["iter_count"] < 10:
            raise RuntimeError(f"the reference solve stopped: {self._solver.stats()['return_status']}")
        return spent


def _rates(x: ca.SX, u: ca.SX) -> ca.SX:
    """State rates of a cart of 1 kg with a pole of 0.3 kg and 0.5 m; x = position, angle, their rates."""
    sin, cos = ca.sin(x[1]), ca.cos(x[1])
    share = 1.0 + 0.3 * sin**2
    cart = (0.5 * 0.3 * sin * x[3] ** 2 + u + 0.3 * 9.81 * cos * sin) / share
    pole = -(0.5 * 0.3 * cos * sin * x[3] ** 2 + u * cos + 1.3 * 9.81 * sin) / (0.5 * share)
    return ca.vertcat(x[2], x[3], cart, pole)
