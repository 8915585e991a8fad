"""How sure a success rate is."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Rate:
    """A rate in [0, 1] with its confidence interval; the rate of nothing is None, its interval [0, 1]."""

    successes: int
    runs: int
    rate: float | None
    low: float
    high: float


def wilson(successes: int, runs: int, confidence: float = 0.95) -> Rate:
    """Success rate with its Wilson score interval (Wilson 1927), which is sound for few runs and at 0 and 1.

    Raises ValueError unless 0 <= successes <= runs.
    """
    if not 0 <= successes <= runs:
        raise ValueError(f"{successes} successes in {runs} runs")
    if runs == 0:
        return Rate(0, 0, None, 0.0, 1.0)
    from scipy.stats import binomtest  # takes half a second to import, and strategies import this module

    interval = binomtest(successes, runs).proportion_ci(confidence, method="wilson")
    return Rate(successes, runs, successes / runs, float(interval.low), float(interval.high))
