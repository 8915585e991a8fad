"""Every installed controller against `checks.controllers`; skipped without what flights need."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.controllers import CHECKS
from benchbench.flight.controller import Controller

pytest.importorskip("mujoco", reason="the extra 'flight' is not installed")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("controllers"), ids=lambda c: c.name)
def test_controller(candidate: Configured, check: Callable[[Controller], None]) -> None:
    """One check of one controller."""
    check(candidate.build())
