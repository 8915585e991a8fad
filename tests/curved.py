"""A block function whose derivatives were worked out by hand; also for other processes, which import nothing else."""

from __future__ import annotations

import casadi as ca
import numpy as np

from benchbench.mpcc.derivatives import Derivatives
from benchbench.mpcc.derivatives import derivatives as derivatives

Z = np.array([0.3, -1.2, 0.8])


def curved(name: str = "curved", factor: float = 2.0) -> ca.Function:
    z, p, s = ca.SX.sym("z", 3), ca.SX.sym("p", 1), ca.SX.sym("sigma")
    out = ca.vertcat(ca.sin(z[0] * z[1]) + s, p * z[2] ** 3 + factor * z[0], z[1])
    return ca.Function(name, [z, p, s], [out])


def check(found: Derivatives) -> None:
    """Value and derivatives at one point, worked out by hand for factor 2, p = 5, sigma = 0.1."""
    a, b, c = Z
    value = np.asarray(found.value(Z, 5.0, 0.1)).ravel()
    np.testing.assert_allclose(value, [np.sin(a * b) + 0.1, 5 * c**3 + 2 * a, b], rtol=1e-14)
    jacobian = np.zeros((3, 3))
    jacobian[found.rows, found.columns] = np.asarray(found.jacobian(Z, 5.0, 0.1)).ravel()
    cos, sin = np.cos(a * b), np.sin(a * b)
    np.testing.assert_allclose(jacobian, [[b * cos, a * cos, 0], [2, 0, 15 * c**2], [0, 1, 0]], rtol=1e-14)
    hessian = np.zeros((3, 3))
    entries = np.asarray(found.hessian(Z, 5.0, 0.1, [1.0, 10.0, 7.0])).ravel()
    hessian[found.hessian_rows, found.hessian_columns] = entries
    upper = [[-b * b * sin, cos - a * b * sin, 0], [0, -a * a * sin, 0], [0, 0, 300 * c]]
    np.testing.assert_allclose(hessian, upper, rtol=1e-13, atol=1e-14)
