"""The one loop over discrete choices: in the order of their lower bounds, pruned by the best found so far.

Shared by every strategy that tries candidates (phase sequences; windows are the same with another candidate): it
knows nothing of flights. What it proves is limited to what it is given: the bounds are proofs, a solve is as good as
its solver, so "exhaustive" means that every candidate was solved, or cannot be better than the one returned.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

C = TypeVar("C")
R = TypeVar("R")


@dataclass(frozen=True)
class Candidate(Generic[C]):
    """A choice and a number that its cost cannot be below."""

    choice: C
    bound: float


@dataclass(frozen=True)
class Found(Generic[R]):
    """What solving a choice gave, and its cost; infinite where the solve failed."""

    result: R
    cost: float


@dataclass(frozen=True)
class Account:
    """What became of all candidates: solved, failed to be solved, pruned by their bound, left for want of time."""

    solved: int = 0
    failed: int = 0
    pruned: int = 0
    left: int = 0

    @property
    def exhaustive(self) -> bool:
        """Whether every candidate was solved or pruned."""
        return self.failed == 0 and self.left == 0

    def told(self, what: str) -> str:
        """One sentence for the record; `what` are the candidates, in the plural."""
        parts = {"solved": self.solved, "pruned": self.pruned, "failed": self.failed, "not tried": self.left}
        total = sum(parts.values())
        counts = ", ".join(f"{count} {name}" for name, count in parts.items() if count)
        verdict = "all were tried" if self.exhaustive else "the others may hold a better plan"
        return f"{total} {what}: {counts}; {verdict}"


def best_first(
    candidates: Iterable[Candidate[C]], solve: Callable[[C], Found[R]], going_on: Callable[[], bool]
) -> tuple[Found[R], Account]:
    """Solve candidates from the smallest bound on until the rest cannot be better, or it is time to stop.

    Returns the best (the first when all failed) and the account. Raises ValueError without candidates.
    """
    waiting = sorted(candidates, key=lambda candidate: candidate.bound)
    best: Found[R] | None = None
    solved = failed = 0
    for place, candidate in enumerate(waiting):
        if best is not None and candidate.bound >= best.cost:
            return best, Account(solved, failed, pruned=len(waiting) - place)
        if best is not None and not going_on():
            return best, Account(solved, failed, left=len(waiting) - place)
        found = solve(candidate.choice)
        if found.cost == float("inf"):
            failed += 1
        else:
            solved += 1
        if best is None or found.cost < best.cost:
            best = found
    if best is None:
        raise ValueError("there is no candidate")
    return best, Account(solved, failed)
