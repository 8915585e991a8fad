"""From rows of the table to costs per problem and method."""

from __future__ import annotations

import numpy as np
import pandas as pd


def solve_time(runs: pd.DataFrame) -> pd.Series:
    """CPU time (s) of the solver: the median of the repeats if every run that has a time was repeated.

    Otherwise the time of the one solve, which all have: repeats start warm, so the two are never mixed.
    """
    median = runs.solve_cpu_median_s.astype(float)
    once = runs.solve_cpu_s.astype(float)
    return median if median.notna().any() and median[once.notna()].notna().all() else once


def plan_time(runs: pd.DataFrame) -> pd.Series:
    """CPU time (s) of construction and solver; medians of the repeats where `solve_time` takes those."""
    solve = solve_time(runs)
    repeated = solve.equals(runs.solve_cpu_median_s.astype(float))
    return solve + (runs.build_cpu_median_s if repeated else runs.build_cpu_s).astype(float)


def by_work(runs: pd.DataFrame) -> pd.DataFrame:
    """CPU time (s) of each run by kind of work; columns that add up to all of it, NaN in a run without times.

    What a solver or an old record does not tell apart stands in a column of its own.
    """
    build, derivatives, solve, functions, rest, certificate = (
        runs[f"{name}_cpu_s"].astype(float)
        for name in ("build", "derivatives", "solve", "functions", "linear_algebra", "certificate")
    )
    split = derivatives.notna()
    parts = {
        "assembly": (build - derivatives).where(split), "derivatives": derivatives, "build": build.mask(split),
        "function evaluations": functions, "linear algebra, rest": rest, "solver": solve.mask(rest.notna()),
        "certificate": certificate,
    }  # fmt: skip
    return _known(parts, solve)


def by_step(runs: pd.DataFrame) -> pd.DataFrame:
    """CPU time (s) inside the solver of each run by step; as in `by_work`."""
    solve, guess, homotopy = (runs[f"{name}_cpu_s"].astype(float) for name in ("solve", "guess", "homotopy"))
    split = guess.notna() & homotopy.notna()
    last = (solve - guess - homotopy).where(split)
    return _known(
        {"guess": guess, "homotopy": homotopy, "last solve": last, "solver": solve.mask(split)}, solve
    )


def _known(parts: dict[str, pd.Series], total: pd.Series) -> pd.DataFrame:
    """Parts that are not there cost nothing, where the run has times at all."""
    table = pd.DataFrame(parts)
    return table.fillna(0.0).where(total.notna())


def cost_matrix(runs: pd.DataFrame, cost: str, success: str = "certified") -> pd.DataFrame:
    """Costs (problems x methods): the median over repeats, a failed run costing infinity.

    runs: rows with the columns `problem`, `method`, `cost` and `success`. A run that succeeded without a
    known cost is left out. NaN where a method never ran; see `comparable`.
    """
    solved = runs[success].fillna(False).astype(bool)
    paid = pd.to_numeric(runs[cost]).astype(float).where(solved, np.inf)
    table = runs[["problem", "method"]].assign(cost=paid).dropna()
    return table.pivot_table(index="problem", columns="method", values="cost", aggfunc="median", sort=False)


def comparable(costs: pd.DataFrame) -> pd.DataFrame:
    """The methods and problems that can be compared: every method here was tried on every problem here.

    Methods tried on the fewest problems are left out as long as that leaves more pairs of method and problem.
    """
    best, rest = costs.dropna(), costs
    while rest.shape[1] > 1:
        rest = rest.drop(columns=rest.notna().sum().idxmin())
        if rest.dropna().size > best.size:
            best = rest.dropna()
    return best
