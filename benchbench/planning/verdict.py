"""A verdict and what it was on, so that a plan that a strategy has looked at need not be judged again in the end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from hashlib import blake2b
from typing import final

import numpy as np

from benchbench.certificate.certificate import Certificate
from benchbench.ground.arrays import Array
from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import AnyCase
from benchbench.planning.result import Result


@final
@dataclass(frozen=True, eq=False)
class Verdict:
    """A certificate of a result of a case, and the digest of the numbers that were judged."""

    case: AnyCase
    result: Result
    digest: bytes
    certificate: Certificate

    def holds(self, result: Result, case: AnyCase) -> bool:
        """Whether it is on this very plan and solution, with the numbers they had then, for the same task, vehicle and limits.

        By identity: a strategy that has changed any of them, or an array in place, is judged anew.
        """
        parts = ("scenario", "limits", "model")
        return (
            self.result.planned is result.planned
            and self.result.posed is result.posed
            and all(getattr(self.case, part, None) is getattr(case, part, None) for part in parts)
            and self.digest == digest(result)
        )


def judged(result: Result, case: AnyCase, ledger: Ledger) -> Certificate:
    """Return the certificate of a result, made now unless this run has made it already."""
    for one in ledger.verdicts:
        if isinstance(one, Verdict) and one.holds(result, case):
            return one.certificate
    found = Verdict(case, result, digest(result), case.judge(result))
    ledger.verdicts.append(found)
    return found.certificate


def digest(result: Result) -> bytes:
    """Digest of all numbers of a plan and of the claimed solution."""
    whole = blake2b()
    for numbers in _numbers(result):
        whole.update(np.ascontiguousarray(numbers).tobytes())
    return whole.digest()


def _numbers(result: Result) -> Iterator[Array]:
    if result.posed is not None:
        yield result.solved.x
    if result.planned is not None:
        values = (getattr(result.planned, field.name) for field in fields(result.planned))
        yield from (value for value in values if isinstance(value, np.ndarray))
