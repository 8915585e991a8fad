"""The convex subproblem, posed to CVXPY once; only its parameters change."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from benchbench.ground.arrays import Array, Index
from benchbench.ground.errors import Unavailable
from benchbench_plugins.solvers.cvxpy_backend_model import LocalModel, LocalProgram


@dataclass(frozen=True)
class Step:
    """d (n,), multipliers of the scaled rows (m,) and of the bounds on d (n,); positive at upper bounds."""

    d: Array
    lam_g: Array
    lam_d: Array


class Subproblem:
    """min gradient . d + d' B d / 2 + weights . slack over low <= d <= high, lower <= g + J d <= upper.

    Slacks make it always feasible: the l1 exact penalty. Disciplined parametrized programming (Agrawal et al.
    2019, "Differentiable convex optimization layers") compiles it once; B and J are sparse parameters.
    """

    def __init__(self, model: LocalModel, solver: str, options: dict[str, Any]) -> None:
        self.model, self.solver, self.options = model, solver, options
        cp = cvxpy()
        self.d = cp.Variable(model.n)
        self.gradient, self.low, self.high = (cp.Parameter(model.n) for _ in range(3))
        self.edges = self.d >= self.low, self.d <= self.high
        cost, self.rows = self.gradient @ self.d, list[_Rows]()
        if model.curvature_pattern[0].size:
            self.curvature = cp.Parameter((model.n, model.n), sparsity=model.curvature_pattern)
            cost += cp.quad_form(self.d, self.curvature, assume_PSD=True) / 2
        if model.m:
            self.jacobian = cp.Parameter((model.m, model.n), sparsity=model.jacobian_pattern)
            self.weights = cp.Parameter(model.m, nonneg=True)
            under, over = (cp.Variable(model.m, nonneg=True) for _ in range(2))
            cost += self.weights @ (under + over)
            self.rows = _rows(model, self.jacobian @ self.d + under - over)
        self.problem = cp.Problem(cp.Minimize(cost), [*self.edges, *(r.rule for r in self.rows)])

    def pose(self, at: LocalProgram, curvature: Array, weights: Array) -> None:
        """Set the model around a point; curvature holds the entries of B at the model's pattern."""
        self.gradient.value = at.gradient
        if self.model.curvature_pattern[0].size:
            shape = (self.model.n, self.model.n)
            self.curvature.value_sparse = sparse.coo_array(
                (curvature, self.model.curvature_pattern), shape=shape
            )
        if self.model.m:
            rows, columns = self.model.jacobian_pattern
            values = np.asarray(at.jacobian[rows, columns]).ravel()
            self.jacobian.value_sparse = sparse.coo_array((values, (rows, columns)), shape=at.jacobian.shape)
            self.weights.value = weights

    def solve(self, g: Array, low: Array, high: Array) -> Step | None:
        """Return the step for row values g (m,) and bounds on d; None when the convex solver fails."""
        self.low.value, self.high.value = low, high
        for rows in self.rows:
            rows.room.value = (rows.bound(self.model) - g)[rows.which]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # "may be inaccurate": the ratio test judges the step
                self.problem.solve(solver=self.solver, **self.options)
        except cvxpy().SolverError:
            return None
        if self.d.value is None or not np.all(np.isfinite(self.d.value)):
            return None
        lam_g = np.zeros(self.model.m)
        for rows in self.rows:
            lam_g[rows.which] += rows.sign * rows.rule.dual_value
        lower, upper = (edge.dual_value for edge in self.edges)
        return Step(np.clip(self.d.value, low, high), lam_g, upper - lower)


@dataclass(frozen=True)
class _Rows:
    """Rows of one kind: `rule` is the CVXPY constraint, `room` its right-hand side, sign that of lam_g."""

    which: Index
    rule: Any
    room: Any
    sign: float
    upper: bool

    def bound(self, model: LocalModel) -> Array:
        return model.bounds[1 if self.upper else 0]


def _rows(model: LocalModel, change: Any) -> list[_Rows]:
    """Equalities, upper and lower bounds of g + change."""
    low, high = model.program.lower_g, model.program.upper_g
    equal = low == high
    kinds = ((equal, 0), (~equal & np.isfinite(high), 1), (~equal & np.isfinite(low), -1))
    found = []
    for mask, sign in kinds:
        which = np.flatnonzero(mask)
        if which.size:
            room = cvxpy().Parameter(which.size)
            part = change[which]
            rule = part == room if sign == 0 else part <= room if sign > 0 else part >= room
            found.append(_Rows(which, rule, room, -1.0 if sign < 0 else 1.0, sign >= 0))
    return found


def cvxpy() -> Any:
    """Import CVXPY; raises Unavailable with the remedy."""
    try:
        import cvxpy as cp
    except ImportError as error:
        raise Unavailable("solver 'cvxpy' needs CVXPY: pip install 'benchbench[cvxpy]'") from error
    return cp
