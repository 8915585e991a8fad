"""Every installed predictor against `checks.predictors`; skipped without what flights need."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.predictors import CHECKS
from benchbench.flight.predictor import Predictor

pytest.importorskip("mujoco", reason="the extra 'flight' is not installed")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("predictors"), ids=lambda c: c.name)
def test_predictor(candidate: Configured, check: Callable[[Predictor], None]) -> None:
    """One check of one predictor."""
    check(candidate.build())
