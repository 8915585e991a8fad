"""The outer loop of sequential convex programming: trust region, penalty weights, acceptance, stopping."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.nlp.solver import Claim, Outcome, Point, Progress
from benchbench_plugins.solvers.cvxpy_backend_model import LocalModel, LocalProgram
from benchbench_plugins.solvers.cvxpy_backend_qp import Step, Subproblem

ACCEPT = 1e-4
"""A step is taken when the merit function falls by this share of what the convex model promised."""
ACCEPTABLE = 100.0
"""Where nothing moves any more, so many tolerances still count as solved, as IPOPT's acceptable level."""
HEAVIEST = 1e8
"""Largest weight of a row; a violation that survives it is called infeasible."""
NOISE = 1e-11
"""Smallest promise, relative to 1 + |f|, that the accuracy of the convex solver can vouch for."""
SMALLEST = 1e-10
"""Trust region in which nothing can move any more."""


@dataclass(frozen=True)
class Rules:
    """Tolerance of violation and KKT residual, limits, first trust region and first weight of a row."""

    tolerance: float
    iterations: int
    seconds: float
    radius: float
    weight: float
    progress: Progress | None = None

    @property
    def negligible(self) -> float:
        """A promise of less than this, relative to 1 + |f|, is none: the tolerance squared, as a step has it."""
        return max(self.tolerance**2, NOISE)


@dataclass(frozen=True)
class Iterate:
    """An iterate x (n,), the program there, multipliers, weights; `promise` is what the last model hoped for.

    `stiffness` in (0, 1] multiplies the curvature, which by its construction is too large.
    """

    x: Array
    at: LocalProgram
    lam_g: Array
    lam_x: Array
    weights: Array
    radius: float
    stiffness: float = 1.0
    promise: float = np.inf


@dataclass(frozen=True)
class SequentialSolve:
    """One solve for one sigma."""

    model: LocalModel
    subproblem: Subproblem
    rules: Rules
    sigma: float

    def run(self, start: Array) -> Outcome:
        """Iterate until `verdict` or a limit ends it."""
        began = time.process_time()
        state, count = self._first(start), 0
        claim: Claim | None = None if state.at.finite else "invalid"
        detail = "not finite at the start"
        while claim is None:
            if count >= self.rules.iterations:
                claim, detail = "iteration_limit", "all iterations used"
            elif time.process_time() - began > self.rules.seconds:
                claim, detail = "time_limit", "all time used"
            else:
                before, state, count = state, self._advance(state), count + 1
                claim, detail = self._verdict(state, before)
                if self.rules.progress:
                    self.rules.progress(count, state.x, float(state.at.violation.max(initial=0.0)))
        point = Point(state.x, state.lam_g * self.model.scale, state.lam_x)
        spent = time.process_time() - began
        return Outcome(claim, point, state.at.f, count, self.model.evaluations, spent, detail)

    def _first(self, start: Array) -> Iterate:
        x = np.clip(start, self.model.program.lower_x, self.model.program.upper_x)
        self.model.begin(x, self.sigma)
        m, n = self.model.m, self.model.n
        weights = np.full(m, self.rules.weight)
        return Iterate(x, self.model.at(x, self.sigma), np.zeros(m), np.zeros(n), weights, self.rules.radius)

    def _advance(self, state: Iterate) -> Iterate:
        """Take one step, with a smaller trust region as often as needed; the same x when none helps."""
        curvature = state.stiffness * self.model.curvature(state.x, self.sigma, state.lam_g)
        self.subproblem.pose(state.at, curvature, state.weights)
        radius = state.radius
        while radius > SMALLEST:
            low, high = self._box(state.x, radius)
            step = self.subproblem.solve(state.at.g, low, high)
            if step is None:
                radius /= 4
                continue
            promise = self._promise(state, step.d, curvature)
            if promise <= NOISE * (1 + abs(state.at.f)):
                return self._polish(replace(state, radius=radius, promise=0.0), step, (low, high))
            x, at, ratio = self._try(state, step, promise, low, high)
            size = float(np.max(np.abs(step.d) / self._reach(state.x), initial=0.0))
            if ratio > ACCEPT:
                known = replace(state, radius=_radius(radius, ratio, size), promise=promise)
                known = replace(known, stiffness=_stiffness(state.stiffness, ratio))
                return self._adopt(known, step, (low, high), x, at)
            radius = 0.4 * min(radius, size)
        return replace(state, radius=radius)

    def _try(
        self, state: Iterate, step: Step, promise: float, low: Array, high: Array
    ) -> tuple[Array, LocalProgram, float]:
        """Judge the step; where it lost for a larger violation, judge its second-order correction."""
        x = state.x + step.d
        at = self.model.at(x, self.sigma)
        before = self._merit(state, state.at)
        ratio = (before - self._merit(state, at)) / promise
        if ratio > ACCEPT or not at.finite or at.violation.sum() <= state.at.violation.sum():
            return x, at, ratio
        corrected = self.subproblem.solve(at.g - state.at.jacobian @ step.d, low, high)
        if corrected is None:
            return x, at, ratio
        x = state.x + corrected.d
        at = self.model.at(x, self.sigma)
        return x, at, (before - self._merit(state, at)) / promise

    def _polish(self, state: Iterate, step: Step, box: tuple[Array, Array]) -> Iterate:
        """Take a step that promises nothing only if it lessens the violation and costs nothing."""
        x = state.x + step.d
        at = self.model.at(x, self.sigma)
        worse = self._merit(state, at) - self._merit(state, state.at)
        if worse <= NOISE * (1 + abs(state.at.f)) and at.violation.max(initial=0) < state.at.violation.max(
            initial=0
        ):
            return self._adopt(state, step, box, x, at)
        return self._adopt(state, step, box, state.x, state.at)

    def _adopt(
        self, state: Iterate, step: Step, box: tuple[Array, Array], x: Array, at: LocalProgram
    ) -> Iterate:
        """Next iterate: a row with slack left weighs four times as much, another near twice its multiplier."""
        needed = 2 * np.abs(step.lam_g)
        left = self.model.outside(state.at.g + state.at.jacobian @ step.d) > 1e-9
        eased = np.maximum(np.maximum(needed, 1.0), (state.weights + needed) / 2)
        weights = np.minimum(np.where(left, 4 * state.weights, eased), HEAVIEST)
        (low, high), program = box, self.model.program
        upper = np.where(high >= program.upper_x - state.x, np.maximum(step.lam_d, 0.0), 0.0)
        lower = np.where(low <= program.lower_x - state.x, np.minimum(step.lam_d, 0.0), 0.0)
        return replace(state, x=x, at=at, lam_g=step.lam_g, lam_x=upper + lower, weights=weights)

    def _verdict(self, state: Iterate, before: Iterate) -> tuple[Claim | None, str]:
        """Solved: violation and either KKT residual or promise are small enough. Else it may be stuck."""
        violation, residual, tolerance = state.at.violation, self._kkt(state), self.rules.tolerance
        worst = float(violation.max(initial=0.0))
        detail = f"violation {worst:.1e}, KKT residual {residual:.1e}, promised decrease {state.promise:.1e}"
        nothing = state.promise <= self.rules.negligible * (1 + abs(state.at.f))
        if worst <= tolerance and (nothing or residual <= tolerance):
            return "solved", detail
        if nothing and worst > tolerance and np.all(state.weights[violation > tolerance] >= HEAVIEST):
            return "infeasible", detail
        still = state.x is before.x and bool(np.all(state.weights <= 1.01 * before.weights))
        if state.radius <= SMALLEST or still:
            acceptable = max(worst, residual) <= ACCEPTABLE * tolerance
            return "solved" if acceptable else "failed", f"no step helps any more, {detail}"
        return None, ""

    def _kkt(self, state: Iterate) -> float:
        """Largest entry of grad f + J' lam_g + lam_x, over the largest multiplier where that exceeds 1."""
        slope = state.at.gradient + state.at.jacobian.T @ state.lam_g + state.lam_x
        largest = max(np.abs(lam).max(initial=1.0) for lam in (state.lam_g, state.lam_x))
        return float(np.abs(slope).max() / largest)

    def _promise(self, state: Iterate, d: Array, curvature: Array) -> float:
        """How much the convex model of the merit function falls along d."""
        rows, columns = self.model.curvature_pattern
        bend = float(np.sum(curvature * d[rows] * d[columns])) / 2
        linear = self.model.outside(state.at.g + state.at.jacobian @ d)
        gained = float(state.weights @ (self.model.outside(state.at.g) - linear))
        return gained - float(state.at.gradient @ d) - bend

    def _merit(self, state: Iterate, at: LocalProgram) -> float:
        """The l1 penalty function with the weights of a state; infinite where something is not finite."""
        return at.f + float(state.weights @ self.model.outside(at.g)) if at.finite else np.inf

    def _reach(self, x: Array) -> Array:
        """How far a trust region of one lets each unknown go: 1, or its value where it must be positive."""
        return np.where(self.model.program.lower_x > 0, x, 1.0)

    def _box(self, x: Array, radius: float) -> tuple[Array, Array]:
        """Bounds of the step; what must be positive (a duration) is at most halved."""
        program, reach = self.model.program, self._reach(x)
        down = np.where(program.lower_x > 0, min(radius, 0.5), radius) * reach
        return np.maximum(program.lower_x - x, -down), np.minimum(program.upper_x - x, radius * reach)


def _radius(radius: float, ratio: float, size: float) -> float:
    """Grow after a good step that met the edge, shrink after a poor one."""
    if ratio > 0.75 and size >= 0.9 * radius:
        return min(2.5 * radius, 1e6)
    return max(0.5 * min(radius, size), 1e-4) if ratio < 0.25 else radius


def _stiffness(stiffness: float, ratio: float) -> float:
    """Soften after a step that gained more than promised, stiffen after one that gained less."""
    if ratio > 1.3:
        return max(0.5 * stiffness, 1e-3)
    return min(2.0 * stiffness, 1.0) if ratio < 0.75 else stiffness
