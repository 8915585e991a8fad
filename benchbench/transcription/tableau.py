"""Butcher tableaus of Runge-Kutta methods, checked when they are built."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from benchbench.ground.arrays import Array

Points = Literal["legendre", "radau"]


@dataclass(frozen=True)
class Tableau:
    """y_1 = y_0 + h sum b_i f(Y_i), Y_i = y_0 + h sum a_ij f(Y_j), at times c_i; `order` of convergence.

    a (s, s), b (s,), c (s,). Raises ValueError when rows do not sum to c or the quadrature misses its order.
    """

    a: Array
    b: Array
    c: Array
    order: int

    def __post_init__(self) -> None:
        """Check c = sum of rows, and that b integrates polynomials up to the order."""
        if not np.allclose(self.a.sum(axis=1), self.c, rtol=0, atol=1e-12):
            raise ValueError("rows of a must sum to c")
        for power in range(self.order):
            if not np.isclose(self.b @ self.c**power, 1 / (power + 1), rtol=0, atol=1e-12):
                raise ValueError(f"b does not integrate t^{power}: the order is below {self.order}")

    @property
    def stages(self) -> int:
        """Number of stages s."""
        return len(self.b)

    @cached_property
    def starts_at_node(self) -> bool:
        """The first stage is the left node (explicit and Lobatto methods)."""
        return bool(np.all(self.a[0] == 0.0))

    @cached_property
    def ends_at_node(self) -> bool:
        """The last stage is the right node (stiffly accurate methods)."""
        return bool(np.allclose(self.a[-1], self.b, atol=1e-14))


RK4 = Tableau(
    np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1.0, 0]]),
    np.array([1, 2, 2, 1]) / 6, np.array([0, 0.5, 0.5, 1.0]), 4,
)  # fmt: skip
TRAPEZOIDAL = Tableau(np.array([[0, 0], [0.5, 0.5]]), np.array([0.5, 0.5]), np.array([0, 1.0]), 2)
HERMITE_SIMPSON = Tableau(
    np.array([[0, 0, 0], [5 / 24, 1 / 3, -1 / 24], [1 / 6, 2 / 3, 1 / 6]]),
    np.array([1, 4, 1]) / 6, np.array([0, 0.5, 1.0]), 4,
)  # fmt: skip


def collocation(degree: int, points: Points) -> Tableau:
    """Collocation at `degree` Gauss-Legendre points (order 2 s) or Radau IIA points (order 2 s - 1)."""
    from scipy.special import roots_jacobi, roots_legendre  # a quarter of a second, which few runs need

    if points == "legendre":
        c, order = (1 + roots_legendre(degree)[0]) / 2, 2 * degree
    else:
        inner = roots_jacobi(degree - 1, 1, 0)[0] if degree > 1 else np.zeros(0)
        c, order = np.append((1 + inner) / 2, 1.0), 2 * degree - 1
    powers = np.arange(degree)
    c = np.asarray(c, dtype=np.float64)
    vandermonde = c[:, None] ** powers
    integrals = c[:, None] ** (powers + 1) / (powers + 1)
    weights = np.linalg.solve(vandermonde.T, np.column_stack([integrals.T, 1 / (powers + 1)])).T.astype(
        np.float64
    )
    return Tableau(weights[:-1], weights[-1], c, order)


def composed(one: Tableau, steps: int) -> Tableau:
    """`steps` equal steps of a method as one step of a larger method."""
    s = one.stages
    a = np.zeros((s * steps, s * steps))
    for k in range(steps):
        block = slice(k * s, (k + 1) * s)
        a[block, block] = one.a / steps
        a[block, : k * s] = np.tile(one.b / steps, k)
    c = np.concatenate([(k + one.c) / steps for k in range(steps)])
    return Tableau(a, np.tile(one.b / steps, steps), c, one.order)
