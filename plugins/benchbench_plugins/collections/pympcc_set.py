"""The problems of the package pympcc, whose optima are known."""

from __future__ import annotations

import math
from typing import Any, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput, Unavailable
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem, whole

EXPONENTIAL = ("scholtes1", "scholtes2")
"""Problems whose G calls math.exp, which takes floats only: G = -exp(x_0) + x_1 - exp(x_2)."""


@final
@dataclass(frozen=True)
class PympccSet(PublishedProblem):
    """One of the thirteen small MPCCs of pympcc (kth1, ralph1, bard1, ...), most of them from MacMPEC.

    problem: its name
    """

    problem: str

    @property
    def name(self) -> str:
        """Name of the problem."""
        return self.problem

    @property
    def published(self) -> Published:
        """The optimum that pympcc says; raises as `mpcc`."""
        return Published(float(self._spec().f_opt), "pympcc, benchmarks")

    def mpcc(self) -> Mpcc:
        """Trace its Python functions with CasADi symbols; raises Unavailable, BadInput."""
        return _convert(self.problem, self._spec().problem)

    def _spec(self) -> Any:
        try:
            from pympcc.benchmarks import ALL_PROBLEMS
        except ImportError:
            raise Unavailable("pympcc is not installed; remedy: pip install benchbench[pympcc]") from None
        found = {spec.name: spec for spec in ALL_PROBLEMS}
        if self.problem not in found:
            raise BadInput("scenario.problem", f"'{self.problem}' does not exist", ", ".join(found))
        return found[self.problem]


def _convert(name: str, p: Any) -> Mpcc:
    w = ca.SX.sym("w", p.n)
    x = np.array([w[i] for i in range(p.n)], dtype=object)

    def trace(key: str, *parts: Any) -> ca.Function:
        return ca.Function(key, [w, ca.SX.sym("p", 0)], [ca.vertcat(ca.SX(0, 1), *(ca.SX(k) for k in parts))])

    g = [-ca.exp(x[0]) + x[1] - ca.exp(x[2])] if name in EXPONENTIAL else p.comp_G(x)
    below = list(p.ineq_constraints(x)) if p.n_ineq else []
    equal = list(p.eq_constraints(x)) if p.n_eq else []
    functions = {
        "f": trace("f", p.objective(x)), "g": trace("g", *below, *equal),
        "G": trace("G", *g), "H": trace("H", *p.comp_H(x)),
    }  # fmt: skip
    low = np.concatenate([np.full(len(below), -math.inf), np.zeros(len(equal))])
    bounds = (np.asarray(p.xl, float), np.asarray(p.xu, float))
    return whole(functions, np.zeros(0), np.asarray(p.x0, float), bounds, (low, np.zeros(len(low))))
