"""Checks that a configuration names beside those that every flight is asked."""

from __future__ import annotations

from collections.abc import Iterable

from benchbench.certificate.check import Check, Checks
from benchbench.certificate.evidence import Evidence
from benchbench.certificate.named import named
from benchbench.ground.errors import BadInput


def further(evidence: Evidence) -> Checks:
    """Ask what `limits.checks` names, in that order; raises BadInput for a function that gives no checks."""
    for name, limit in evidence.limits.checks.items():
        if limit is None:
            continue
        given = named(name)(evidence) if limit is True else named(name)(evidence, limit)
        for check in given if isinstance(given, Iterable) else [given]:
            if not isinstance(check, Check):
                problem = f"gives a {type(check).__name__}"
                raise BadInput(f"certificate.checks.{name}", problem, "a benchbench.Check, or several")
            yield check
