"""The nonlinear program of a horizon, by multiple shooting, solved to convergence."""

from __future__ import annotations

from typing import Any, final

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench_plugins.controllers.condensed import ERRORS, Weights
from benchbench_plugins.controllers.prediction import INPUTS, STATES, Prediction, stage


@final
class Converged:
    """min sum |S (x_k - x_ref)|^2 + |u - u_ref|^2_R with x+ = f(x, u) + offset and bounds on u; states are unknowns, too."""

    def __init__(
        self, prediction: Prediction, weights: Weights, low: Array, high: Array, gravity: float, step: float
    ) -> None:
        """low, high: (4,) bounds of u."""
        self.prediction, self.stages = prediction, len(prediction.inputs)
        n, w = self.stages, weights
        self.low, self.high = np.tile(low, n), np.tile(high, n)
        x, u = ca.SX.sym("x", STATES, n), ca.SX.sym("u", INPUTS, n)
        first, offset = ca.SX.sym("first", STATES), ca.SX.sym("offset", STATES, n)
        ref, wanted = ca.SX.sym("ref", STATES, n), ca.SX.sym("wanted", INPUTS, n)
        error, lever = ca.SX.sym("error", 12, n), ca.SX.sym("lever", 9, n)
        scale = ca.DM([w.position] * 3 + [w.attitude] * 3 + [w.velocity] * 3)
        model, cost, rows = stage(gravity, step), ca.SX(0), []
        for k in range(n):
            before = first if k == 0 else x[:, k - 1]
            rows.append(x[:, k] - model(before, u[:, k], offset[:, k])[0])
            turn = ca.reshape(error[:, k], 4, 3).T @ x[3:7, k]
            wrong = ca.vertcat(x[:3, k] - ref[:3, k], turn, x[7:, k] - ref[7:, k])
            change, arm = u[:, k] - wanted[:, k], ca.reshape(lever[:, k], 3, 3).T
            cost += ca.dot(scale, wrong**2) + ca.dot(ca.DM([w.rates] * 3 + [w.thrust]), change**2)
            counts = ca.if_else(ca.sumsqr(arm) > 0, w.tip, 0)
            cost += counts * ca.sumsqr(wrong[6:] + arm @ change[:3])
        unknowns = ca.vertcat(ca.vec(x), ca.vec(u))
        given = ca.vertcat(first, ca.vec(offset), ca.vec(ref), ca.vec(wanted), ca.vec(error), ca.vec(lever))
        quiet: dict[str, Any] = {"print_level": 0, "sb": "yes", "tol": 1e-6, "mu_init": 1e-3}
        problem = {"x": unknowns, "f": cost, "g": ca.vertcat(*rows), "p": given}
        self.solver = ca.nlpsol("nmpc", "ipopt", problem, {"ipopt": quiet, "print_time": False})
        free = np.full(STATES * n, np.inf)
        self.bounds = (np.append(-free, self.low), np.append(free, self.high))
        assert wrong.numel() == ERRORS

    def solve(self, state: Array, inputs: Array, error: Array, lever: Array) -> Array:
        """As `Condensed.solve`, from the same prediction. Raises ArithmeticError where IPOPT fails."""
        p = self.prediction
        asked = (p.offsets, state, inputs, error, lever)
        given = np.concatenate([p.first, *(part.ravel() for part in asked)])
        start = np.append(p.after.ravel(), p.inputs.ravel())
        found = self.solver(x0=start, p=given, lbx=self.bounds[0], ubx=self.bounds[1], lbg=0, ubg=0)
        if not self.solver.stats()["success"]:
            raise ArithmeticError(
                f"the nonlinear program was not solved: {self.solver.stats()['return_status']}"
            )
        return np.asarray(found["x"].full().ravel()[STATES * self.stages :].reshape(self.stages, INPUTS))
