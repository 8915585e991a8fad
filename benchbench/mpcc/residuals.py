"""Residuals of a point in the *original* MPCC, never in a relaxed one; scaled as the MPCC is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, evaluate


@dataclass(frozen=True)
class PairResidual:
    """Worst violation over all pairs of one block; H+ = max(H, 0) for a vanishing pair, else H.

    negativity   max(-G, -H, 0); for a vanishing pair max(-G, 0), because its H may have any sign
    natural      max |min(G, H+)|: how far the nearer of the two is from where it must be
    product      max G * H+: reported, not judged; it depends on the scale of H, and on both being small
    """

    negativity: float
    natural: float
    product: float


@dataclass(frozen=True)
class Residuals:
    """Violations, 0 is perfect; NaN wherever the point or a function value is NaN.

    bounds       worst violation of a bound of the unknowns
    constraints  worst violation of each constraint block, by name
    pairs        of each pair block, by name
    cost         value of the cost, which is no violation, but has to be a number
    """

    bounds: float
    constraints: dict[str, float]
    pairs: dict[str, PairResidual]
    cost: float = 0.0

    @property
    def max_violation(self) -> float:
        """Worst violation of bounds and constraints."""
        return _worst([self.bounds, *self.constraints.values()])

    @property
    def max_complementarity(self) -> float:
        """Worst of negativity and natural residual over all pairs."""
        return _worst([x for p in self.pairs.values() for x in (p.negativity, p.natural)])

    @property
    def max_negativity(self) -> float:
        """Worst violation of a sign over all pairs."""
        return _worst([p.negativity for p in self.pairs.values()])

    @property
    def max_product(self) -> float:
        """Largest product over all pairs."""
        return _worst([p.product for p in self.pairs.values()])

    @property
    def worst_constraint(self) -> str:
        """Name of the most violated constraint block, or "bounds"."""
        named = {"bounds": self.bounds, **self.constraints}
        return max(named, key=lambda name: np.inf if np.isnan(named[name]) else named[name])


def residuals(mpcc: Mpcc, x: Array) -> Residuals:
    """Evaluate bounds, constraints and pairs of an MPCC at x (n,); blocks of one name are taken together."""
    with np.errstate(over="ignore", invalid="ignore"):  # a diverged point has infinite residuals
        return _residuals(mpcc, np.asarray(x, float))


def _residuals(mpcc: Mpcc, x: Array) -> Residuals:
    bounds = _worst(_outside(x, mpcc.lower, mpcc.upper))
    constraints: dict[str, float] = {}
    for block in mpcc.constraints:
        found = _worst(_outside(_values(block, mpcc, x), block.lower, block.upper))
        constraints[block.name] = _worst([found, constraints.get(block.name, 0.0)])
    pairs: dict[str, PairResidual] = {}
    for pair in mpcc.pairs:
        new, old = _pair(pair, mpcc, x), pairs.get(pair.block.name, PairResidual(0.0, 0.0, 0.0))
        pairs[pair.block.name] = PairResidual(
            _worst([new.negativity, old.negativity]),
            _worst([new.natural, old.natural]),
            _worst([new.product, old.product]),
        )
    cost = float(sum(np.sum(_values(block, mpcc, x)) for block in mpcc.costs))
    return Residuals(bounds, constraints, pairs, cost)


def _pair(pair: Pair, mpcc: Mpcc, x: Array) -> PairResidual:
    g, h = np.split(_values(pair.block, mpcc, x), 2, axis=1)
    vanishing = pair.kind == "vanishing"
    signed = [-g] if vanishing else [-g, -h]
    h = np.maximum(h, 0) if vanishing else h
    return PairResidual(_worst(signed), _worst(np.abs(np.minimum(g, h))), _worst(g * h))


def _values(block: Block, mpcc: Mpcc, x: Array) -> Array:
    if block.instances == 0:
        return np.zeros((0, block.function.size1_out(0)))
    return evaluate(block, mpcc, x)


def _outside(value: Array, lower: Array, upper: Array) -> Array:
    return np.maximum(lower - value, value - upper)


def _worst(values: Array | list[float] | list[Array]) -> float:
    """Largest value, at least 0; NaN if any is NaN."""
    return float(np.max(np.asarray(values), initial=0.0))
