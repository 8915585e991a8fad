"""Every installed world against `checks.worlds`; skipped without what flights need."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.worlds import CHECKS
from benchbench.flight.world import World

pytest.importorskip("mujoco", reason="the extra 'flight' is not installed")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("worlds"), ids=lambda c: c.name)
def test_world(candidate: Configured, check: Callable[[World], None]) -> None:
    """One check of one world."""
    check(candidate.build())
