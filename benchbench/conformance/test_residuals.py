"""Every installed residual against `checks.residuals`; skipped without what flights need."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.residuals import CHECKS
from benchbench.flight.residual import Residual

pytest.importorskip("mujoco", reason="the extra 'flight' is not installed")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("residuals"), ids=lambda c: c.name)
def test_residual(candidate: Configured, check: Callable[[Residual], None]) -> None:
    """One check of one residual."""
    check(candidate.build())
