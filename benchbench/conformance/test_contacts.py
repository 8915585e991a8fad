"""Every installed contact on every installed model against `checks.contacts`."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.contacts import CHECKS
from benchbench.ocp.contact import Contact
from benchbench.ocp.model import Model


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("model", candidates("models"), ids=lambda c: c.name)
@pytest.mark.parametrize("candidate", candidates("contacts"), ids=lambda c: c.name)
def test_contact(candidate: Configured, model: Configured, check: Callable[[Contact, Model], None]) -> None:
    """One check of one contact on one model."""
    check(candidate.build(), model.build())
