"""The one loop over discrete choices: in the order of their lower bounds, pruned by the best found so far.

Shared by every strategy that tries candidates (phase sequences, windows, orders of gates): it knows nothing of flights.
What it proves is limited to what it is given: the bounds are proofs, a solve is as good as its solver, so "exhaustive"
means that every candidate was solved, or cannot be better than the one returned.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from itertools import count
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
    """What became of all candidates: solved, failed to be solved, pruned by their bound, left for want of time.

    `split`: candidates that stood for several and were replaced by them; one that was pruned or left may stand for
    several too.
    """

    solved: int = 0
    failed: int = 0
    pruned: int = 0
    left: int = 0
    split: int = 0

    @property
    def exhaustive(self) -> bool:
        """Whether every candidate was solved or pruned."""
        return self.failed == 0 and self.left == 0

    def told(self, what: str) -> str:
        """One sentence for the record; `what` are the candidates, in the plural."""
        parts = {"solved": self.solved, "pruned": self.pruned, "failed": self.failed, "not tried": self.left}
        parts |= {"split": self.split} if self.split else {}
        total = sum(parts.values())
        counts = ", ".join(f"{number} {name}" for name, number in parts.items() if number)
        verdict = "all were tried" if self.exhaustive else "the others may hold a better plan"
        return f"{total} {what}: {counts}; {verdict}"


def whole(choice: C) -> Sequence[Candidate[C]]:
    """Split nothing."""
    return ()


def best_first(
    candidates: Iterable[Candidate[C]],
    solve: Callable[[C], Found[R]],
    going_on: Callable[[], bool],
    split: Callable[[C], Sequence[Candidate[C]]] = whole,
) -> tuple[Found[R], Account]:
    """Solve candidates from the smallest bound on until the rest cannot be better, or it is time to stop.

    A choice that `split` replaces by several is never solved itself (branch and bound); equal bounds in the order they
    came. Returns the best (the first when all failed) and the account. Raises ValueError without candidates.
    """
    number = count()
    waiting = [(candidate.bound, next(number), candidate) for candidate in candidates]
    heapify(waiting)
    best: Found[R] | None = None
    account = Account()
    while waiting:
        if best is not None and waiting[0][0] >= best.cost:
            return best, replace(account, pruned=len(waiting))
        if best is not None and not going_on():
            return best, replace(account, left=len(waiting))
        choice = heappop(waiting)[2].choice
        if parts := split(choice):
            account = replace(account, split=account.split + 1)
            for part in parts:
                heappush(waiting, (part.bound, next(number), part))
            continue
        found = solve(choice)
        failed = found.cost == float("inf")
        account = replace(account, solved=account.solved + (not failed), failed=account.failed + failed)
        if best is None or found.cost < best.cost:
            best = found
    if best is None:
        raise ValueError("there is no candidate")
    return best, account
