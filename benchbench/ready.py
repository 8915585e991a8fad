"""Interface of an MPCC that comes ready-made from a collection, and what makes one of whole CasADi functions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import casadi as ca
import numpy as np

from benchbench.mpcc import Block, Mpcc, Pair, Slot, Variable
from benchbench.plan import Array


class ReadyMade(ABC):
    """A scenario that is no flight: it enters at the waist, without vehicle, dynamics, guess or plan."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the problem, the record's scenario."""

    @abstractmethod
    def mpcc(self) -> Mpcc:
        """Return the problem, guessed as the collection says; raises BadInput where it cannot be read."""


def whole(
    functions: Mapping[str, ca.Function], parameters: Array, start: Array, unknowns: tuple[Array, Array],
    rows: tuple[Array, Array],
) -> Mpcc:  # fmt: skip
    """Minimise f(w, p) with lower <= w <= upper, lower <= g(w, p) <= upper, 0 <= G(w, p), H(w, p) complementary.

    functions   "f", "g", "G" and "H" of (w, p), SX or MX
    parameters  (n_p,) values of p; start (n,) guess of w, clipped into its bounds
    unknowns    lower and upper bounds of w, each (n,); rows: of g, each (m,)

    Each function becomes one block with one instance: its derivatives are CasADi's sparse ones of the whole.
    Raises ValueError where sizes do not fit or a number is none, RuntimeError where CasADi finds other faults.
    """
    _check_numbers(parameters, start, unknowns, rows)
    for key, function in functions.items():
        sizes = tuple(function.numel_in(i) for i in range(function.n_in()))
        if sizes != (start.size, parameters.size):
            raise ValueError(f"{key} takes {sizes} numbers, but w has {start.size} and p {parameters.size}")
    w, p, sigma = ca.SX.sym("w", start.size), ca.SX.sym("p", parameters.size), ca.SX.sym("sigma")

    def block(name: str, keys: tuple[str, ...], lower: Array, upper: Array) -> Block:
        out = ca.densify(ca.vertcat(*(functions[key].expand()(w, p) for key in keys)))
        if out.numel() != lower.size:
            raise ValueError(
                f"{' and '.join(keys)} give {out.numel()} numbers, but there are {lower.size} bounds"
            )
        function = ca.Function(name, [w, p, sigma], [out])
        every = Slot("w", np.arange(start.size)[None, :])
        return Block(name, function, (every,), parameters[None, :], lower[None, :], upper[None, :])

    lower, upper, guess = (k.reshape(-1, 1) for k in (*unknowns, np.clip(start, *unknowns)))
    none = np.zeros(2 * functions["G"].size1_out(0))
    constraints = (block("g", ("g",), *rows),) if rows[0].size else ()
    pairs = (Pair(block("GH", ("G", "H"), none, none), "complementarity"),) if none.size else ()
    one = np.zeros(1)
    return Mpcc((Variable("w", lower, upper, guess),), constraints, (block("f", ("f",), one, one),), pairs)


def _check_numbers(
    parameters: Array, start: Array, unknowns: tuple[Array, Array], rows: tuple[Array, Array]
) -> None:
    """Raise ValueError for NaN, for bounds that do not match or are crossed; bounds may be infinite."""
    for name, values in (("p", parameters), ("the start of w", start)):
        if not np.all(np.isfinite(values)):
            raise ValueError(
                f"{name} has {values[~np.isfinite(values)][0]} in place {np.argmin(np.isfinite(values))}"
            )
    for name, (lower, upper), size in (("w", unknowns, start.size), ("g", rows, rows[0].size)):
        if lower.size != size or upper.size != size:
            raise ValueError(
                f"{name} has {size} numbers, but {lower.size} lower and {upper.size} upper bounds"
            )
        wrong = ~(lower <= upper)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise ValueError(f"bounds of {name} in place {k} are {lower[k]:g} and {upper[k]:g}")
