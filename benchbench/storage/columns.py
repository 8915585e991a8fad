"""Columns of the record that only some kinds of scenario fill."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from benchbench.ocp.handover import Handover
from benchbench.ocp.scenario import Scenario


@singledispatch
def columns(scenario: Scenario) -> dict[str, Any]:
    """Return what the record says of the task, by column; nothing, if the kind does not say."""
    return {}


@columns.register
def _(scenario: Handover) -> dict[str, Any]:
    return {"kappa_init": scenario.kappa_init}
