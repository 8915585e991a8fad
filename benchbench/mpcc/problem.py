"""The waist: a mathematical program with complementarity constraints (MPCC) as plain data.

Unknowns are named arrays. Every constraint, cost term and complementarity pair is a *block*: one small
CasADi function applied to many tuples of unknowns. Parts made in different places add up with `+`, because
a block addresses unknowns by variable name and position, never by a global index.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array, Flags, Index

PairKind = Literal["complementarity", "vanishing"]


@dataclass(frozen=True)
class Variable:
    """A named array of unknowns, numbers only; `lower`, `upper`, `guess` have equal shape (rows, columns).

    `integer`: the model means whole numbers; a solver that knows only real ones may ignore it.
    """

    name: str
    lower: Array
    upper: Array
    guess: Array
    unit: str = ""
    integer: bool = False

    def __post_init__(self) -> None:
        """Check shapes and that no bound is NaN or crossed; raises ValueError naming the variable."""
        if not (self.lower.shape == self.upper.shape == self.guess.shape) or self.guess.ndim != 2:
            raise ValueError(f"variable {self.name}: lower, upper and guess need one shape (rows, columns)")
        if not np.all(self.lower <= self.upper):
            raise ValueError(f"variable {self.name}: a lower bound exceeds its upper bound or is NaN")

    @property
    def size(self) -> int:
        """Number of scalar unknowns."""
        return self.guess.size


@dataclass(frozen=True)
class Slot:
    """Which entries of one variable each instance of a block reads: flat positions (instances, width)."""

    variable: str
    index: Index


def rows(variable: str, width: int, which: Iterable[int]) -> Slot:
    """Slot that gives instance i the whole row `which[i]` of a variable with `width` columns."""
    which = np.fromiter(which, dtype=np.int64)
    return Slot(variable, which[:, None] * width + np.arange(width))


@dataclass(frozen=True)
class Block:
    """One function on many instances: `function(z, p, sigma) -> out`.

    z (n_z,) are the unknowns gathered by `slots` in order, p (n_p,) the instance's row of `parameters`
    (instances, n_p), sigma a scalar. `lower`, `upper` have shape (instances, n_out); a cost block ignores
    them and adds up its single output.
    """

    name: str
    function: ca.Function
    slots: tuple[Slot, ...]
    parameters: Array
    lower: Array
    upper: Array
    unit: str = ""

    @property
    def instances(self) -> int:
        """How many times the function is applied."""
        return len(self.parameters)


def block(
    name: str,
    slots: Sequence[Slot],
    rule: Callable[..., Any],
    lower: Any = 0.0,
    upper: Any = 0.0,
    *,
    parameters: Array | None = None,
    unit: str = "",
    function: str = "",
    symbols: str = "",
    sigma: ca.SX | None = None,
) -> Block:
    """Make a block of a rule, which says what one instance gives of what it reads.

    rule        of the unknowns that each slot reads, (width,) each, and of p (n_p,) where there are parameters; returns
                an expression (n_out,) or a list of scalar ones
    parameters  (instances, n_p); lower, upper: broadcast to (instances, n_out), 0 unless given
    function    name of its function, where several blocks share one; symbols: names of what the slots read, in order
    sigma       the symbol of sigma, where the rule knows it
    Raises ValueError where there are not as many names as slots.
    """
    count, widths = len(slots[0].index), [slot.index.shape[1] for slot in slots]
    numbers = np.zeros((count, 0)) if parameters is None else np.asarray(parameters, float)
    z, p = ca.SX.sym("z", sum(widths)), ca.SX.sym("p", numbers.shape[1])
    reads = ca.vertsplit(z, np.cumsum([0, *widths]).tolist())
    if names := symbols.split():
        if len(names) != len(slots):
            raise ValueError(f"block {name}: {len(names)} names for {len(slots)} slots")
        reads = [ca.SX.sym(*one) for one in zip(names, widths, strict=True)]
        z = ca.vertcat(*reads)
    out = rule(*reads) if parameters is None else rule(*reads, p)
    out = ca.vertcat(*out) if isinstance(out, list | tuple) else out
    low, high = (np.array(np.broadcast_to(b, (count, out.shape[0])), float) for b in (lower, upper))
    made = ca.Function(function or name, [z, p, ca.SX.sym("sigma") if sigma is None else sigma], [out])
    return Block(name, made, tuple(slots), numbers, low, high, unit)


@dataclass(frozen=True)
class Pair:
    """Complementarity pairs; the block's function returns [G; H] stacked, (2 m,) for m pairs.

    kind "complementarity": 0 <= G  perpendicular to  H >= 0.
    kind "vanishing":       G >= 0 and G * H <= 0, H of any sign (Achtziger & Kanzow 2008, doi:10.1007/s10107-006-0083-3):
                            where G > 0 the condition H <= 0 must hold, where G = 0 it vanishes.
    `limit` (m,) is set where H = (gap / limit)^2 - 1 for a physical gap >= 0 in `unit`.
    `sign_known`: G >= 0 is a bound or constraint of the problem already. The block's own bounds are ignored.
    """

    block: Block
    kind: PairKind
    limit: tuple[float, ...] | None = None
    sign_known: bool = False

    @property
    def count(self) -> int:
        """Number of scalar pairs over all instances."""
        return int(self.block.instances * self.block.function.size1_out(0) // 2)


@dataclass(frozen=True)
class Mpcc:
    """A whole problem or a part of one: minimise the costs subject to constraints and pairs."""

    variables: tuple[Variable, ...] = ()
    constraints: tuple[Block, ...] = ()
    costs: tuple[Block, ...] = ()
    pairs: tuple[Pair, ...] = field(default=())

    def __add__(self, other: Mpcc) -> Mpcc:
        """Join two parts; raises ValueError when both bring a variable of the same name."""
        clash = {v.name for v in self.variables} & {v.name for v in other.variables}
        if clash:
            raise ValueError(f"two parts both define variable {sorted(clash)}")
        return Mpcc(
            self.variables + other.variables,
            self.constraints + other.constraints,
            self.costs + other.costs,
            self.pairs + other.pairs,
        )

    @property
    def offsets(self) -> dict[str, int]:
        """First position of each variable in the stacked vector of unknowns."""
        starts = np.cumsum([0] + [v.size for v in self.variables])
        return {v.name: int(s) for v, s in zip(self.variables, starts, strict=False)}

    @property
    def size(self) -> int:
        """Number of scalar unknowns n."""
        return sum(v.size for v in self.variables)

    @property
    def lower(self) -> Array:
        """Lower bounds of all unknowns, (n,)."""
        return _stack(v.lower for v in self.variables)

    @property
    def upper(self) -> Array:
        """Upper bounds of all unknowns, (n,)."""
        return _stack(v.upper for v in self.variables)

    @property
    def guess(self) -> Array:
        """Initial guess of all unknowns, (n,)."""
        return _stack(v.guess for v in self.variables)

    @property
    def integer(self) -> Flags:
        """Which unknowns are whole numbers, (n,)."""
        return np.concatenate([np.zeros(0, bool), *(np.full(v.size, v.integer) for v in self.variables)])

    @property
    def digest(self) -> str:
        """Hash of everything but the guesses: equal digest means the same problem."""
        text = hashlib.sha256()
        for v in self.variables:
            kind = "integer" if v.integer else ""
            text.update(f"{v.name}{v.guess.shape}{kind}".encode() + v.lower.tobytes() + v.upper.tobytes())
        for pair in self.pairs:
            text.update(f"{pair.kind}{pair.limit}{pair.sign_known}".encode())
        roles = {"row": self.constraints, "cost": self.costs, "pair": [pair.block for pair in self.pairs]}
        for role, block in ((role, block) for role, blocks in roles.items() for block in blocks):
            text.update(f"{role}{block.name}{block.function.serialize()}".encode())
            for numbers in (block.parameters, block.lower, block.upper, gather(block, self.offsets)):
                text.update(np.ascontiguousarray(numbers).tobytes())
        return text.hexdigest()[:32]

    def split(self, x: Array) -> dict[str, Array]:
        """Cut a stacked vector (n,) into named arrays of each variable's shape."""
        parts = np.split(np.asarray(x, float), np.cumsum([v.size for v in self.variables])[:-1])
        return {v.name: part.reshape(v.guess.shape) for v, part in zip(self.variables, parts, strict=True)}

    def stacked(self, values: Mapping[str, Array]) -> Array:
        """Stack named arrays of each variable's shape, (n,): what `split` cuts. Raises ValueError for one that is missing or of another shape."""
        if missing := [v.name for v in self.variables if v.name not in values]:
            raise ValueError(f"it has no '{missing[0]}'")
        for v in self.variables:
            if values[v.name].shape != v.guess.shape:
                raise ValueError(f"'{v.name}' has the shape {values[v.name].shape}, not {v.guess.shape}")
        return _stack(values[v.name] for v in self.variables)

    def start_from(self, values: dict[str, Array]) -> Mpcc:
        """Return the same problem with other guesses (clipped into the bounds) for the named variables."""
        moved = (
            replace(v, guess=np.clip(values[v.name].reshape(v.guess.shape), v.lower, v.upper))
            if v.name in values
            else v
            for v in self.variables
        )
        return replace(self, variables=tuple(moved))


def gather(block: Block, offsets: dict[str, int]) -> Index:
    """Positions in the stacked vector that each instance reads, shape (instances, n_z)."""
    return np.concatenate([slot.index + offsets[slot.variable] for slot in block.slots], axis=1)


def evaluate(block: Block, mpcc: Mpcc, x: Array, sigma: float = 0.0) -> Array:
    """Value of a block at x (n,), shape (instances, n_out)."""
    return evaluated(block, np.asarray(x, float)[gather(block, mpcc.offsets)], sigma)


def evaluated(block: Block, z: Array, sigma: float = 0.0) -> Array:
    """Value of a block where its instances read z (instances, n_z), shape (instances, n_out)."""
    mapped = block.function.map(block.instances)
    out = mapped(z.T, block.parameters.T, np.full((1, block.instances), sigma))
    return np.asarray(ca.densify(out)).T


def _stack(parts: Iterable[Array]) -> Array:
    return np.concatenate([np.zeros(0), *(p.ravel() for p in parts)])
