"""Every installed autopilot against `checks.autopilots`; skipped without what flights need."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.autopilots import CHECKS
from benchbench.flight.autopilot import Autopilot

pytest.importorskip("mujoco", reason="the extra 'flight' is not installed")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("autopilots"), ids=lambda c: c.name)
def test_autopilot(candidate: Configured, check: Callable[[Autopilot], None]) -> None:
    """One check of one autopilot."""
    check(candidate.build())
