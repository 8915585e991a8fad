"""Interface of an MPCC that comes ready-made from a collection, and what makes one of whole CasADi functions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, Slot, Variable


class ReadyMade(ABC):
    """A scenario that is no flight: it enters at the waist, without vehicle, dynamics, guess or plan."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the problem, the record's scenario."""

    @abstractmethod
    def mpcc(self) -> Mpcc:
        """Return the problem, guessed as the collection says; raises BadInput where it cannot be read."""


@dataclass(frozen=True)
class Published:
    """An optimum that somebody published: the objective, and where it stands."""

    objective: float
    source: str


class PublishedProblem(ReadyMade):
    """One whose optimum is published, beside which ours is shown."""

    @property
    @abstractmethod
    def published(self) -> Published | None:
        """The published optimum, of the whole problem where ours is a discretised one; None for a member of the set without one."""


def whole(
    functions: Mapping[str, ca.Function], parameters: Array, start: Array, unknowns: tuple[Array, Array],
    rows: tuple[Array, Array],
) -> Mpcc:  # fmt: skip
    """Minimise f(w, p) with lower <= w <= upper, lower <= g(w, p) <= upper, 0 <= G(w, p), H(w, p) complementary.

    functions   "f", "g", "G" and "H" of (w, p), SX or MX
    parameters  p0 (n_p,), values of p; start w0 (n,), guess of w, clipped into its bounds
    unknowns    lbw, ubw (n,), lower and upper bounds of w; rows: lbg, ubg (m,), of g

    Each function becomes one block with one instance: its derivatives are CasADi's sparse ones of the whole.
    Raises ValueError where sizes do not fit or a number is none, RuntimeError where CasADi finds other faults.
    """
    _check_finite("p0", parameters)
    _check_finite("w0", start)
    _check_bounds(("lbw", "ubw"), unknowns, start.size, "w0 has")
    _check_bounds(("lbg", "ubg"), rows, functions["g"].numel_out(0), "g gives")
    _check_functions(functions, parameters.size, start.size)
    w, p, sigma = ca.SX.sym("w", start.size), ca.SX.sym("p", parameters.size), ca.SX.sym("sigma")

    def block(name: str, keys: tuple[str, ...], lower: Array, upper: Array) -> Block:
        out = ca.densify(ca.vertcat(*(ca.vec(functions[key].expand()(w, p)) for key in keys)))
        function = ca.Function(name, [w, p, sigma], [out])
        every = Slot("w", np.arange(start.size)[None, :])
        return Block(
            name, function, (every,),
            parameters=parameters[None, :], lower=lower[None, :], upper=upper[None, :],
        )  # fmt: skip

    lower, upper, guess = (k.reshape(-1, 1) for k in (*unknowns, np.clip(start, *unknowns)))
    none = np.zeros(2 * functions["G"].numel_out(0))
    constraints = (block("g", ("g",), *rows),) if rows[0].size else ()
    pairs = (Pair(block("GH", ("G", "H"), none, none), "complementarity"),) if none.size else ()
    one = np.zeros(1)
    return Mpcc((Variable("w", lower, upper, guess),), constraints, (block("f", ("f",), one, one),), pairs)


def _check_finite(name: str, values: Array) -> None:
    wrong = ~np.isfinite(values)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise ValueError(f"{name}[{k}] is {values[k]}, must be finite")


def _check_bounds(names: tuple[str, str], bounds: tuple[Array, Array], size: int, whose: str) -> None:
    """Raise ValueError unless each has `size` numbers, none NaN, that leave a finite one between them."""
    for name, values in zip(names, bounds, strict=True):
        if values.size != size:
            raise ValueError(f"{name} has {values.size} numbers, must have as many as {whose}, {size}")
        if np.isnan(values).any():
            k = int(np.argmax(np.isnan(values)))
            raise ValueError(f"{name}[{k}] is nan, must be a number or infinite")
    (low, high), (lower, upper) = names, bounds
    wrong = (lower > upper) | (lower == np.inf) | (upper == -np.inf)
    if wrong.any():
        k = int(np.argmax(wrong))
        text = f"{low}[{k}] is {lower[k]:g} and {high}[{k}] {upper[k]:g}"
        raise ValueError(f"{text}, must be {low} <= {high} with a finite number between")


def _check_functions(functions: Mapping[str, ca.Function], n_p: int, n: int) -> None:
    """Raise ValueError unless each takes (n,) and (n_p,) numbers, f gives one, and H as many as G."""
    wanted = {"f": 1, "H": functions["G"].numel_out(0)}
    for key, function in functions.items():
        takes = [function.numel_in(i) for i in range(function.n_in())]
        if takes != [n, n_p]:
            raise ValueError(f"{key} takes {takes} numbers, must take {[n, n_p]}, as many as w0 and p0 have")
        gives = [function.numel_out(i) for i in range(function.n_out())]
        if len(gives) != 1 or gives[0] != wanted.get(key, gives[0]):
            what = {"f": "[1]", "H": f"as many as G, [{wanted['H']}]"}.get(key, "one list")
            raise ValueError(f"{key} gives {gives} numbers, must give {what}")
