"""An MPCC without pairs in CVXPY's atoms: one vector expression per instruction, for all instances at once."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Block, Mpcc, gather
from benchbench_plugins.solvers.cvxpy_backend_qp import cvxpy
from benchbench_plugins.solvers.walk import ALGEBRA, Inexpressible, Operations, is_number, record


class Atoms:
    """`problem` in the unknowns `x` (n,) for one sigma.

    CVXPY copies expressions as trees, so a value used more than once becomes a variable with a row of its
    own (N = 25: 5438 beside 492 unknowns), and so does a quotient: q b = a, since CVXPY's own division
    assumes b >= 0. `broken` names a row that no unknown can mend.
    """

    def __init__(self, mpcc: Mpcc, sigma: float) -> None:
        self.cp, self.offsets, self.sigma = cvxpy(), mpcc.offsets, sigma
        self.x = self.cp.Variable(mpcc.size, bounds=[mpcc.lower, mpcc.upper])
        self.rules: list[Any] = []
        self.lifted: list[tuple[Any, Any, Any]] = []
        self.broken = ""
        self.operations = self._operations()
        for block in mpcc.constraints:
            for k, body in enumerate(self._outputs(block) if block.instances else ()):
                self._bound(f"{block.name}[{k}]", body, block.lower[:, k], block.upper[:, k])
        cost = sum(self._total(block) for block in mpcc.costs if block.instances)
        self.problem = self.cp.Problem(self.cp.Minimize(cost), self.rules)

    def start(self, x: Array) -> None:
        """Set the value of the unknowns, and of what was lifted from them."""
        self.x.value = np.clip(x, *self.x.bounds)
        for variable, numerator, denominator in self.lifted:
            values = [part if is_number(part) else part.value for part in (numerator, denominator)]
            variable.value = np.broadcast_to(np.divide(*values), variable.shape)

    def _outputs(self, block: Block) -> list[Any]:
        index = gather(block, self.offsets)
        inputs = [[self.x[column] for column in index.T], list(block.parameters.T), [self.sigma]]
        try:
            return record(block.function).run(inputs, self.operations, self._share)[0]
        except Inexpressible as missing:
            raise IncompatibleCase(
                "solver",
                f"CVXPY's nonlinear interface has no '{missing}', which '{block.name}' needs",
                "ipopt",
            ) from missing

    def _total(self, block: Block) -> Any:
        (out,) = self._outputs(block)
        return np.sum(np.broadcast_to(out, block.instances)) if is_number(out) else self.cp.sum(out)

    def _bound(self, name: str, body: Any, low: Array, high: Array) -> None:
        if is_number(body):
            if not np.all((low - 1e-9 <= body) & (body <= high + 1e-9)):
                self.broken = f"{name} = {body} is outside its bounds"
            return
        equal = low == high
        for mask, compare, bound in (
            (equal, operator.eq, low),
            (~equal & np.isfinite(low), operator.ge, low),
            (~equal & np.isfinite(high), operator.le, high),
        ):
            which = np.flatnonzero(mask)
            if which.size:
                self.rules.append(compare(body if which.size == len(low) else body[which], bound[which]))

    def _share(self, value: Any) -> Any:
        return self._lift(value, 1.0)

    def _lift(self, numerator: Any, denominator: Any) -> Any:
        """A new variable q with q * denominator == numerator."""
        shapes = [part.shape for part in (numerator, denominator) if hasattr(part, "shape")]
        q = self.cp.Variable(np.broadcast_shapes(*shapes))
        left = q if is_number(denominator) else self.cp.multiply(q, denominator)
        self.rules.append(left == numerator)
        self.lifted.append((q, numerator, denominator))
        return q

    def _divide(self, a: Any, b: Any) -> Any:
        return self.cp.multiply(a, 1 / b) if is_number(b) else self._lift(a, b)

    def _power(self, a: Any, b: Any) -> Any:
        if not is_number(a) and np.ndim(b) == 0:
            return self.cp.power(a, b) if b >= 0 else self._divide(1.0, self.cp.power(a, -b))
        raise Inexpressible("pow")

    def _operations(self) -> Operations:
        cp = self.cp
        return {
            **ALGEBRA,
            "mul": cp.multiply, "div": self._divide, "inv": lambda a: self._divide(1.0, a),
            "sq": cp.square, "pow": self._power, "constpow": self._power, "sqrt": cp.sqrt,
            "exp": cp.exp, "log": cp.log, "sin": cp.nlp.sin, "cos": cp.nlp.cos, "tanh": cp.nlp.tanh,
            "sinh": cp.nlp.sinh, "asinh": cp.nlp.asinh,
            "tan": lambda a: self._divide(cp.nlp.sin(a), cp.nlp.cos(a)),
        }  # fmt: skip
