"""Every installed payload against `checks.payloads`; skipped without what flights need."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.payloads import CHECKS
from benchbench.flight.payload import Payload

pytest.importorskip("mujoco", reason="the extra 'flight' is not installed")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("payloads"), ids=lambda c: c.name)
def test_payload(candidate: Configured, check: Callable[[Payload], None]) -> None:
    """One check of one payload."""
    check(candidate.build())
