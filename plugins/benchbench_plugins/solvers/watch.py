"""What CasADi calls at each iteration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import final

import casadi as ca
import numpy as np

from benchbench.mpcc.spending import cpu_s
from benchbench.nlp.program import Program
from benchbench.nlp.solver import Progress, Setup


@final
class SolverWatch(ca.Callback):
    """Called each iteration: hands it to the progress display, and stops a plugin without a time limit."""

    def __init__(self, program: Program, setup: Setup) -> None:
        ca.Callback.__init__(self)
        n, m = len(program.lower_x), len(program.lower_g)
        self.sizes = {"x": n, "f": 1, "g": m, "lam_x": n, "lam_g": m, "lam_p": 1}
        self.program, self.progress, self.seconds = program, setup.progress, setup.seconds
        self.begin()
        self.construct("watch", {})

    def begin(self) -> None:
        """Start counting iterations and CPU time."""
        self.count, self.began, self.late = 0, cpu_s(), False

    def get_n_in(self) -> int:
        """Number of inputs: what a solver returns."""
        return ca.nlpsol_n_out()

    def get_n_out(self) -> int:
        """One: whether to stop."""
        return 1

    def get_name_in(self, i: int) -> str:
        """Names of a solver's outputs."""
        return ca.nlpsol_out(i)

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Dense columns of the problem's sizes."""
        return ca.Sparsity.dense(self.sizes[ca.nlpsol_out(i)], 1)

    def eval(self, arguments: Sequence[ca.DM]) -> list[int]:
        """Show the iterate; return 1 to stop."""
        if self.progress:
            self._show(
                self.progress, dict(zip(map(ca.nlpsol_out, range(len(arguments))), arguments, strict=True))
            )
        self.count += 1
        self.late = cpu_s() - self.began > self.seconds
        return [int(self.late)]

    def _show(self, progress: Progress, values: Mapping[str, ca.DM]) -> None:
        g = np.asarray(values["g"]).ravel()
        violation = np.maximum(self.program.lower_g - g, g - self.program.upper_g).max(initial=0.0)
        progress(self.count, np.asarray(values["x"]).ravel(), float(violation))
