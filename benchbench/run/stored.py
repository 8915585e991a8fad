"""What is made of a configuration that was stored with results, which is data: installed plugins, see `trust`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from omegaconf import OmegaConf

from benchbench.certificate.limits import Limits
from benchbench.ground import registry
from benchbench.ground.errors import BadInput
from benchbench.mpcc.ready import ReadyMade
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.run import trust
from benchbench.run.config import make, scenario_of

SCENE = ("models", "motions", "contacts", "collections", "scenarios", *registry.PARTS)
"""Families of plugins that scenario and vehicle are made of."""


def scene_parts(tree: Mapping[str, Any]) -> tuple[Scenario, Model]:
    """Make the scenario and the vehicle: what it takes to show a plan.

    The other choices may be those of an earlier version, or of a plugin that is not here. Raises BadInput.
    """
    scenario, model = (_make(tree, family) for family in ("scenario", "vehicle"))
    if isinstance(scenario, ReadyMade):
        raise BadInput("scenario", f"'{scenario.name}' is no flight", "a flight")
    return scenario_of(scenario), model


def problem_of(tree: Mapping[str, Any]) -> ReadyMade:
    """Make the scenario of an MPCC that came ready-made. Raises BadInput."""
    found = _make(tree, "scenario")
    if not isinstance(found, ReadyMade):
        raise BadInput("scenario", "is a flight", "a problem that comes ready-made")
    return found


def limits(tree: Mapping[str, Any]) -> Limits:
    """Make the limits that a flight is judged by. Raises BadInput."""
    made = _make(tree, "certificate")
    if not isinstance(made, Limits):
        raise BadInput("certificate", "is for problems that are no flight", "task, race")
    return made


def _make(tree: Mapping[str, Any], family: str) -> Any:
    trust.check(tree.get(family), family, SCENE)
    return make(OmegaConf.create({family: tree.get(family)}), family)
