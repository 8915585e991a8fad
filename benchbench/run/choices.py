"""What can be chosen, by the names of files and entry points alone: for answers that need not wait for Hydra to be imported."""

from __future__ import annotations

import os
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import chain
from pathlib import Path

from benchbench.ground import registry
from benchbench.ground.errors import BadInput
from benchbench.ground.families import PLANNED

GROUPS = {
    "dynamics": "dynamics", "relaxations": "relaxation", "solvers": "solver", "strategies": "strategy",
    "guesses": "guess", "peers": "peer", "contacts": "scenario/contact", "motions": "scenario/motion",
    "worlds": "world", "controllers": "controller", "autopilots": "autopilot", "residuals": "residual",
    "payloads": "payload", "predictors": "predictor",
}  # fmt: skip
"""Where the choices of a family of plugins are. Vehicles and scenarios are numbers, so that theirs are always YAML."""
EVERY = (*GROUPS.items(), ("costs", "scenario/cost"), ("contacts", "scenario/obstacle"))
"""The same with what a scenario may have besides, as pairs: an obstacle is a contact that is always kept."""
FAMILIES = (*PLANNED, "certificate")
"""What a run chooses from, in the order of the help."""
PARTS = ("handover", "hardware")
"""YAML files that others build on; nothing to choose by itself."""


def folder() -> str:
    """Absolute path of the configuration: $BENCHBENCH_CONF, else the installed one, else the checkout's. Raises BadInput."""
    here = Path(__file__).resolve().parents[1]
    asked = os.environ.get("BENCHBENCH_CONF")
    for candidate in [Path(asked)] if asked else [here / "conf", here.parent / "conf"]:
        if (candidate / "config.yaml").is_file():
            return str(candidate.resolve())
    raise BadInput(
        "BENCHBENCH_CONF", f"there is no config.yaml in '{asked}'", "the path of benchbench's conf folder"
    )


def choices(family: str, *own: Path) -> list[str]:
    """Names of everything that can be chosen from a family; own: further folders with configuration. Raises BadInput.

    As Hydra finds them on our search path: YAML of ours, of third parties' packages, then plugins.
    """
    yaml = (
        path.stem
        for place in (Path(folder()), *_packages(), *own)
        for path in (place / family).glob("*.yaml")
    )
    plugins = (registry.entries(kind) for kind, group in EVERY if group == family)
    return sorted({*yaml, *chain.from_iterable(plugins)} - {*PARTS})


def _packages() -> Iterator[Path]:
    """Folders of third parties' configuration."""
    for entry in chain.from_iterable(registry.entries("conf").values()):
        spec = find_spec(entry.value)
        yield from map(Path, (spec and spec.submodule_search_locations) or ())
