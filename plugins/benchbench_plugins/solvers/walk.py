"""Evaluates a CasADi function over any objects: modelling languages build their expressions this way.

An SX function is a list of scalar instructions. Doing them in order with the operations of, say, Pyomo gives
the same function in Pyomo; with arrays or CVXPY vectors as entries it is done for many instances at once.
Constants are folded with NumPy, and 0 a = 0, 1 a = a, a + 0 = a: block parameters such as the phase weights
of a step size leave only what they select.
"""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from scipy.special import erf

Operations = Mapping[str, Callable[..., Any]]
"""What to do for the operation of each name, on operands of which at least one is no number."""

NUMBERS: dict[str, Callable[..., Any]] = {
    "assign": lambda a: a, "twice": lambda a: 2 * a, "sq": lambda a: a * a, "inv": lambda a: 1 / a,
    "neg": operator.neg, "add": operator.add, "sub": operator.sub, "mul": operator.mul,
    "div": np.true_divide, "pow": np.power, "constpow": np.power, "fmod": np.fmod, "hypot": np.hypot,
    "exp": np.exp, "log": np.log, "sqrt": np.sqrt, "log1p": np.log1p, "expm1": np.expm1, "erf": erf,
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan,
    "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh,
    "asinh": np.arcsinh, "acosh": np.arccosh, "atanh": np.arctanh, "atan2": np.arctan2,
    "fabs": np.abs, "sign": np.sign, "copysign": np.copysign, "floor": np.floor, "ceil": np.ceil,
    "fmin": np.minimum, "fmax": np.maximum, "lt": np.less, "le": np.less_equal, "eq": np.equal,
    "ne": np.not_equal, "not": np.logical_not, "and": np.logical_and, "or": np.logical_or,
    "if_else_zero": lambda condition, a: np.where(condition, a, 0.0),
}  # fmt: skip
"""Every operation on floats and arrays, by CasADi's name without "OP_"."""

ALGEBRA: dict[str, Callable[..., Any]] = {
    **{name: NUMBERS[name] for name in ("assign", "twice", "sq", "inv", "neg", "add", "sub", "mul")},
    "div": operator.truediv, "pow": operator.pow, "constpow": operator.pow,
}  # fmt: skip
"""The operations that Python operators express, to start `Operations` from."""

NAMES = {getattr(ca, f"OP_{name.upper()}"): name for name in (*NUMBERS, "const", "input", "output")}


class Inexpressible(Exception):
    """The function uses an operation that the target does not have; the message is its name."""


@dataclass(frozen=True)
class Instruction:
    """One value: an operation on earlier values, a constant, or entry `place` (input, entry) of the inputs.

    `shared`: it is used more than once.
    """

    name: str
    operands: tuple[int, ...] = ()
    constant: float = 0.0
    place: tuple[int, int] = (0, 0)
    shared: bool = False


@dataclass(frozen=True)
class Tape:
    """The instructions of a function; `outputs` says which step gives each entry of each output."""

    steps: tuple[Instruction, ...]
    outputs: tuple[tuple[int, ...], ...]

    def reads(self, which: int) -> bool:
        """Whether any entry of an input is used."""
        return any(step.name == "input" and step.place[0] == which for step in self.steps)

    def run(
        self,
        inputs: Sequence[Sequence[Any]],
        operations: Operations,
        share: Callable[[Any], Any] = lambda value: value,
    ) -> list[list[Any]]:
        """Return the entries of every output, column by column; `inputs` are given the same way.

        `share` gets every computed value that is used more than once and returns what shall stand for it.
        Raises Inexpressible.
        """
        values: list[Any] = []
        with np.errstate(all="ignore"):
            for step in self.steps:
                if step.name == "const":
                    value: Any = step.constant
                elif step.name == "input":
                    value = inputs[step.place[0]][step.place[1]]
                else:
                    operands = [values[i] for i in step.operands]
                    value = _apply(step.name, operands, operations)
                    new = not is_number(value) and all(value is not operand for operand in operands)
                    value = share(value) if step.shared and new else value
                values.append(value)
        return [[values[i] for i in output] for output in self.outputs]


def record(function: ca.Function) -> Tape:
    """Read the instructions of a function; an MX function is expanded, equal expressions are joined.

    Raises Inexpressible for operations that have no scalar form.
    """
    scalar = function if function.is_a("SXFunction") else function.expand()
    symbols = scalar.sx_in()
    results = ca.cse([ca.densify(out) for out in scalar.call(symbols)])
    plain = ca.Function("plain", symbols, results)
    entries = [symbol.sparsity().find() for symbol in symbols]
    steps: list[Instruction] = []
    outputs = [[0] * out.numel() for out in results]
    register: dict[int, int] = {}
    for k in range(plain.n_instructions()):
        name = NAMES.get(plain.instruction_id(k), "")
        read, written = plain.instruction_input(k), plain.instruction_output(k)
        if name == "output":
            outputs[written[0]][written[1]] = register[read[0]]
            continue
        if name == "const":
            step = Instruction(name, constant=float(plain.instruction_constant(k)))
        elif name == "input":
            step = Instruction(name, place=(read[0], entries[read[0]][read[1]]))
        elif name:
            step = Instruction(name, tuple(register[i] for i in read))
        else:
            raise Inexpressible(f"operation {plain.instruction_id(k)} of CasADi")
        register[written[0]] = len(steps)
        steps.append(step)
    uses = Counter(i for step in steps for i in step.operands) + Counter(i for out in outputs for i in out)
    marked = tuple(replace(step, shared=uses[i] > 1) for i, step in enumerate(steps))
    return Tape(marked, tuple(tuple(output) for output in outputs))


def is_number(value: Any) -> bool:
    """Whether a value is a float, or an array of floats."""
    return isinstance(value, (float, int, np.ndarray, np.generic))


def _apply(name: str, operands: list[Any], operations: Operations) -> Any:
    if all(is_number(a) for a in operands):
        return NUMBERS[name](*operands)
    a, b = operands[0], operands[-1]
    match name:
        case "add" if _all(a, 0) or _all(b, 0):
            return b if _all(a, 0) else a
        case "sub" if _all(b, 0):
            return a
        case "mul" if _all(a, 0) or _all(b, 0):
            return 0.0
        case "mul" if _all(a, 1) or _all(b, 1):
            return b if _all(a, 1) else a
        case "div" | "if_else_zero" if _all(a if name == "div" else b, 0):
            return 0.0
    if name not in operations:
        raise Inexpressible(name)
    return operations[name](*operands)


def _all(value: Any, number: float) -> bool:
    return is_number(value) and bool(np.all(value == number))
