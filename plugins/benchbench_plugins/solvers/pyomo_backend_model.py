"""An MPCC as a Pyomo model, equation by equation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase, Unavailable
from benchbench.mpcc.problem import Block, Mpcc, Pair, gather
from benchbench_plugins.solvers.walk import ALGEBRA, Inexpressible, Operations, is_number, record


@dataclass(frozen=True)
class PyomoModel:
    """A `pyomo.environ.ConcreteModel` and where the MPCC's parts are in it.

    unknowns   the Pyomo variable of each unknown (n,)
    rows       the Pyomo constraint of each constraint row (m,), None for a row without unknowns
    sigma      a Pyomo variable: fix it, or take it for a parameter of the written problem
    auxiliary  variables that Pyomo's transformation of the pairs added, with the expressions they equal
    broken     what is wrong with a row that no unknown can mend, empty normally
    """

    model: Any
    unknowns: tuple[Any, ...]
    rows: tuple[Any, ...]
    sigma: Any
    auxiliary: tuple[tuple[Any, Any], ...]
    broken: str

    def start(self, x: Array) -> None:
        """Set the value of every variable but sigma."""
        from pyomo.environ import value

        for unknown, number in zip(self.unknowns, x, strict=True):
            unknown.set_value(float(number), skip_validation=True)
        for variable, expression in self.auxiliary:
            variable.set_value(max(value(expression), 0.0), skip_validation=True)


def build(mpcc: Mpcc) -> PyomoModel:
    """Return the model; pairs become `pyomo.mpec` components, transformed by `mpec.simple_nonlinear`.

    That is H >= 0, v = G >= 0, H v <= 0 with a new variable v. Raises Unavailable, and IncompatibleCase for
    an operation that Pyomo cannot write.
    """
    pyo = pyomo()
    writer = _Writer(pyo, mpcc)
    rows = [writer.row(*row) for block in mpcc.constraints for row in writer.rows(block)]
    costs = [out for block in mpcc.costs for (out,) in writer.outputs(block)]
    writer.model.cost = pyo.Objective(expr=sum(costs))
    auxiliary = writer.complement(mpcc.pairs)
    model, broken = writer.model, "; ".join(writer.broken[:1])
    return PyomoModel(model, tuple(writer.unknowns), tuple(rows), model.sigma, auxiliary, broken)


def pyomo() -> Any:
    """Import Pyomo; raises Unavailable with the remedy."""
    try:
        import pyomo.environ as pyo
    except ImportError as error:
        raise Unavailable("solver 'pyomo' needs Pyomo: pip install 'benchbench[pyomo]'") from error
    return pyo


class _Writer:
    """Turns blocks into expressions; a value used more than once becomes a named Expression.

    Without names the 30 000 operations of 25 Verlet intervals are written out as 840 000.
    """

    def __init__(self, pyo: Any, mpcc: Mpcc) -> None:
        self.pyo, self.offsets, self.operations = pyo, mpcc.offsets, _operations(pyo)
        self.model = model = pyo.ConcreteModel()
        self.unknowns: list[Any] = []
        self.broken: list[str] = []
        model.unknowns = pyo.Block()
        for variable in mpcc.variables:
            low, high = ([_finite(b) for b in side.ravel()] for side in (variable.lower, variable.upper))
            made = pyo.Var(range(variable.size))
            model.unknowns.add_component(variable.name, made)
            for i, unknown in made.items():
                unknown.setlb(low[i])
                unknown.setub(high[i])
            self.unknowns += list(made.values())
        model.sigma = pyo.Var(initialize=0.0)
        model.shared = pyo.Expression(pyo.Any)
        model.row = pyo.Constraint(pyo.Any)

    def outputs(self, block: Block) -> Iterator[list[Any]]:
        """Expressions of all outputs, instance by instance."""
        try:
            tape = record(block.function)
            for index, parameters in zip(gather(block, self.offsets), block.parameters.tolist(), strict=True):
                inputs = [[self.unknowns[i] for i in index], parameters, [self.model.sigma]]
                yield tape.run(inputs, self.operations, self._share)[0]
        except Inexpressible as missing:
            raise IncompatibleCase(
                "solver",
                f"Pyomo cannot write '{missing}', which '{block.name}' needs",
                "another relaxation or solver",
            ) from missing

    def rows(self, block: Block) -> Iterator[tuple[str, Any, float, float]]:
        """Name, body, lower and upper bound of each row."""
        for i, outputs in enumerate(self.outputs(block)):
            for k, body in enumerate(outputs):
                yield f"{block.name}[{i}, {k}]", body, float(block.lower[i, k]), float(block.upper[i, k])

    def row(self, name: str, body: Any, low: float, high: float) -> Any:
        """Add low <= body <= high and return it; None for a number, which holds or is `broken`."""
        if is_number(body):
            if not low - 1e-9 <= body <= high + 1e-9:
                self.broken.append(f"{name} is {body:g}, which must be from {low:g} to {high:g}")
            return None
        key = len(self.model.row)
        self.model.row[key] = (low, body, high) if low == high else (_finite(low), body, _finite(high))
        return self.model.row[key]

    def complement(self, pairs: tuple[Pair, ...]) -> tuple[tuple[Any, Any], ...]:
        """Add the pairs and transform them; returns the new variables and what they equal."""
        if not pairs:
            return ()
        from pyomo.mpec import Complementarity, complements

        self.model.touch = Complementarity(self.pyo.Any)
        scalar = [gh for pair in pairs for out in self.outputs(pair.block) for gh in _halves(out)]
        first: list[Any] = []
        for g, h in scalar:
            if is_number(g) or is_number(h):  # Pyomo takes no constants here
                number, other = (g, h) if is_number(g) else (h, g)
                self.row("side of a pair", number, 0.0, np.inf)
                self.row("other side of a pair", other, 0.0, 0.0 if number > 0 else np.inf)
            else:
                self.model.touch[len(first)] = complements(g >= 0, h >= 0)
                first.append(g)
        self.pyo.TransformationFactory("mpec.simple_nonlinear").apply_to(self.model)
        return tuple((self.model.touch[k].v, g) for k, g in enumerate(first))

    def _share(self, value: Any) -> Any:
        key = len(self.model.shared)
        self.model.shared[key] = value
        return self.model.shared[key]


def _halves(outputs: list[Any]) -> Iterator[tuple[Any, Any]]:
    count = len(outputs) // 2
    return zip(outputs[:count], outputs[count:], strict=True)


def _finite(bound: float) -> float | None:
    return float(bound) if np.isfinite(bound) else None


def _operations(pyo: Any) -> Operations:
    """What both Pyomo and CasADi's reader of .nl files know; that one has no asinh, acosh, atanh and no if."""
    names = ("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh",
             "floor", "ceil")  # fmt: skip
    return {
        **ALGEBRA,
        **{name: getattr(pyo, name) for name in names},
        "fabs": abs,
        "fmin": lambda a, b: (a + b - abs(a - b)) / 2,
        "fmax": lambda a, b: (a + b + abs(a - b)) / 2,
        "log1p": lambda a: pyo.log(1 + a),
        "expm1": lambda a: pyo.exp(a) - 1,
        "hypot": lambda a, b: pyo.sqrt(a * a + b * b),
    }
