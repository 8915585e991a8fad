"""One step of DOP853 for many states at once, with its error estimate and its dense output.

Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, Sec. II.10. scipy.integrate has the method, but takes 0.3 s to
import, as much as a whole solve, and has one step size and one error norm for all states.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchbench.certificate.dop853_coefficients import EXTRA, FIFTH, STAGES, THIRD, A, C, D
from benchbench.ground.arrays import Array

Rate = Callable[[float, Array], Array]
"""dy/dx (M, n) at a fraction x in [0, 1] of the step, for y (M, n)."""


@dataclass(frozen=True)
class Step:
    """One step of M states: start and end (M, n), slopes (13, M, n) at the stages, the rate they came from."""

    rate: Rate
    start: Array
    end: Array
    slopes: Array

    def error(self, tolerance: float) -> Array:
        """Estimated error (M,) of each step over what is tolerated, as Hairer's program estimates it.

        `tolerance` is absolute and relative; root mean square over the components.
        """
        scale = tolerance * (1 + np.maximum(np.abs(self.start), np.abs(self.end)))
        fifth, third = (
            np.mean((np.tensordot(e, self.slopes[:STAGES], 1) / scale) ** 2, axis=-1) for e in (FIFTH, THIRD)
        )
        whole = fifth + 0.01 * third
        return np.asarray(fifth / np.sqrt(np.where(whole > 0, whole, 1.0)))

    def curve(self) -> Array:
        """Terms (8, M, n) of the dense output, which `along` takes; three more evaluations of the rate."""
        slopes = np.concatenate([self.slopes, np.empty((3, *self.start.shape))])
        for i in EXTRA:
            slopes[i] = self.rate(float(C[i]), self.start + np.tensordot(A[i, :i], slopes[:i], 1))
        way = self.end - self.start
        bends = way - slopes[STAGES], slopes[0] - way
        terms = [self.start, way, bends[1], bends[0] - bends[1], *np.tensordot(D, slopes, 1)]
        return np.stack(terms)


def step(rate: Rate, start: Array) -> Step:
    """Make one step from x = 0 to 1; thirteen evaluations of the rate."""
    slopes = np.empty((STAGES + 1, *start.shape))
    slopes[0] = rate(0.0, start)
    for i in range(1, STAGES + 1):
        end = start + np.tensordot(A[i, :i], slopes[:i], 1)
        slopes[i] = rate(float(C[i]), end)
    return Step(rate, start, end, slopes)


def along(terms: Array, x: Array) -> Array:
    """States (m, n) at fractions x (m,) of their steps, terms (8, m, n): Horner in turn with x and 1 - x."""
    x = x[:, None]
    found = np.zeros_like(terms[0])
    for i, term in enumerate(terms[:0:-1]):
        found = (found + term) * (x if i % 2 == 0 else 1 - x)
    return np.asarray(found + terms[0])
