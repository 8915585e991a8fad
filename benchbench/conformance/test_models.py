"""Every installed model against `checks.models`."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.models import CHECKS
from benchbench.ocp.model import Model


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("candidate", candidates("models"), ids=lambda candidate: candidate.name)
def test_model(candidate: Configured, check: Callable[[Model], None]) -> None:
    """One check of one model."""
    check(candidate.build())
