"""How an MPCC is solved: what the homotopy reads of a case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from benchbench.mpcc.derivatives import Compile
from benchbench.nlp.relaxation import Relaxation
from benchbench.nlp.solver import Accuracy, Solver


@dataclass(frozen=True, kw_only=True)
class Method:
    """Relaxation, solver and their limits; `names` are the names of the choices, by family."""

    relaxation: Relaxation
    solver: Solver
    names: Mapping[str, str]
    seed: int = 0
    accuracy: Accuracy = "high"
    compile: Compile = "auto"
    time_limit: float = 300.0
    iteration_limit: int = 3000
