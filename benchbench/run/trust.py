"""What a configuration that was read from a folder of results may name: installed plugins, and nothing else.

Hydra makes whatever class or function a `_target_` names. A configuration that somebody types or keeps in their own YAML is their
code; one that lies beside results is data, and commands that read results make nothing of it but plugins that are installed.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import is_dataclass
from importlib import import_module
from typing import Any

from pydantic import BaseModel

from benchbench.ground import registry
from benchbench.ground.errors import BadInput

VALUES = (
    "benchbench.certificate.limits", "benchbench.flight.limits", "benchbench.flight.mismatch", "benchbench.flight.rig",
)  # fmt: skip
"""The modules of what our own YAML names beside plugins."""
SPECIAL = ("_args_", "_partial_", "_recursive_")
"""Further keys that change what Hydra makes of a node."""


def check(tree: Any, place: str, families: Collection[str] = (*registry.FAMILIES, *registry.PARTS)) -> None:
    """Raise BadInput where a part of a configuration names something else than an installed plugin of these families.

    tree: plain values that stood at `place` of the configuration. Text with an interpolation is refused, too.
    """
    if isinstance(tree, dict):
        _check_node(tree, place, families)
        for key, value in tree.items():
            check(value, f"{place}.{key}", families)
    elif isinstance(tree, list):
        for i, value in enumerate(tree):
            check(value, f"{place}.{i}", families)
    elif isinstance(tree, str) and "${" in tree:
        raise BadInput(
            place, f"'{tree}' stands in a stored configuration", "what it meant when the run was made"
        )


def _check_node(node: dict[Any, Any], place: str, families: Collection[str]) -> None:
    if "_target_" in node and not _installed(str(node["_target_"]), families):
        problem = f"'{node['_target_']}' stands in a stored configuration and cannot be loaded: it is no installed plugin"
        allowed = (
            "a plugin that `benchbench plugins` lists; results are read as data, so nothing else is loaded"
        )
        raise BadInput(f"{place}._target_", problem, allowed)
    for key in SPECIAL:
        if key in node:
            raise BadInput(f"{place}.{key}", "stands in a stored configuration", "nothing but values")
    if node.get("trust"):
        problem = "stands in a stored configuration: nobody here said that its file may do anything"
        raise BadInput(f"{place}.trust", problem, "false")
    checks = node.get("checks")
    for name in checks if isinstance(checks, dict) else ():
        if "." in str(name):
            problem = "stands in a stored configuration and cannot be loaded: it is a function by its path"
            raise BadInput(f"{place}.checks.{name}", problem, "a check that an installed package registers")


def _installed(target: str, families: Collection[str]) -> bool:
    """Whether a dotted name is a plugin, or a value that the module of a plugin defines, also by the name of its package."""
    registered = registry.targets(families)
    if target in {entry.replace(":", ".") for entry in registered}:
        return True
    modules = {entry.partition(":")[0] for entry in registered} | {*VALUES}
    module, _, name = target.rpartition(".")
    if not any(own == module or own.startswith(f"{module}.") for own in modules if module):
        return False
    try:
        kind = getattr(import_module(module), name, None)
    except Exception:  # noqa: BLE001  # an installed plugin that cannot be loaded is told where it is made
        return True
    if not isinstance(kind, type) or kind.__module__ not in modules:
        return False
    return is_dataclass(kind) or issubclass(kind, BaseModel)
