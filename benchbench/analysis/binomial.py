"""What counts of successes prove, exactly."""

from __future__ import annotations

CONFIDENCE = 0.95
"""Of every bound."""


def exact_bound(successes: int, runs: int) -> float:
    """Lower bound of a success rate, one-sided, exact (Clopper and Pearson 1934): 59 of 59 prove 0.95 at 95 %."""
    from scipy.stats import beta  # half a second to import

    return 0.0 if successes == 0 else float(beta.ppf(1 - CONFIDENCE, successes, runs - successes + 1))


def decided(successes: int, runs: int, most: int, target: float) -> bool:
    """Whether so many runs prove a target rate already, or `most` runs cannot prove it any more."""
    return exact_bound(successes, runs) >= target or exact_bound(successes + most - runs, most) < target
