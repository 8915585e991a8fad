"""What there is to test: every installed plugin, in every configuration that names it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from inspect import signature
from typing import Any

import hydra
from hydra.core.global_hydra import GlobalHydra
from hydra.core.object_type import ObjectType
from hydra.errors import InstantiationException
from omegaconf import OmegaConf

from benchbench.ground.registry import installed
from benchbench.run import choices, config
from benchbench.run.choice import choice

GROUPS = {"models": "vehicle"} | {
    family: group for family, group in choices.GROUPS.items() if family not in ("peers", "motions")
}
"""Where the choices of a family with a suite are."""


@dataclass(frozen=True)
class Configured:
    """One plugin as configured; `error` says why it cannot even be built."""

    name: str
    kind: type | None
    settings: dict[str, Any]
    error: str = ""

    def build(self, **changes: Any) -> Any:
        """Return the plugin, some settings replaced; raises AssertionError when it cannot be built."""
        if self.kind is None:
            raise AssertionError(f"{self.name}: {self.error}")
        if missing := self._missing(changes):
            raise AssertionError(
                f"{self.name}: {self.kind.__name__} has no default for {', '.join(missing)}, and no configuration "
                f"names it; give it defaults, or a YAML in a package of the entry points benchbench.conf"
            )
        try:
            return hydra.utils.instantiate(
                {"_target_": f"{self.kind.__module__}.{self.kind.__qualname__}", **self.settings, **changes},
                _convert_="all",
            )
        except InstantiationException as error:
            raise AssertionError(f"{self.name} cannot be built from {self.settings}: {error}") from error

    def _missing(self, changes: Mapping[str, Any]) -> list[str]:
        """Parameters without a value, of a plugin that no configuration names."""
        if self.settings or self.kind is None:
            return []
        parameters = signature(self.kind).parameters.values()
        named = [p for p in parameters if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]
        return [p.name for p in named if p.default is p.empty and p.name not in changes]


@cache
def candidates(family: str) -> tuple[Configured, ...]:
    """Return every choice of a family, and every installed plugin that is none."""
    plugins = installed(family)
    names = {plugin.kind: plugin.name for plugin in plugins if plugin.kind}
    configured = [_candidate(label, settings, names) for label, settings in _settings(GROUPS[family])]
    seen = {candidate.kind for candidate in configured} - {None}
    failed = {candidate.name for candidate in configured if candidate.kind is None}
    bare = [
        Configured(p.name, p.kind, {}, p.error)
        for p in plugins
        if p.kind not in seen and p.name not in failed
    ]
    return (*configured, *bare)


def _candidate(label: str, settings: dict[str, Any], names: dict[type, str]) -> Configured:
    """Find the class; `label` is the YAML's name, put behind the plugin's where they differ."""
    try:
        kind = hydra.utils.get_class(settings["_target_"])
    except Exception as error:  # noqa: BLE001  # importing somebody's module can raise anything
        return Configured(label, None, {}, f"{settings.get('error') or error}")
    name = names.get(kind, label)
    rest = {key: value for key, value in settings.items() if key != "_target_"}
    return Configured(name if name == label else f"{name}-{label}", kind, rest)


def _settings(group: str) -> Iterator[tuple[str, dict[str, Any]]]:
    with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        for name in GlobalHydra.instance().config_loader().get_group_options(group, ObjectType.CONFIG):
            try:
                composed = OmegaConf.to_container(choice(group, name), resolve=True)
            except Exception as error:  # noqa: BLE001  # a YAML file can be wrong in any way
                composed = {"error": f"{group}/{name}: {error}"}
            yield name, _innermost(composed)


def _innermost(tree: Any) -> dict[str, Any]:
    """Return the mapping with a `_target_`, wherever its package put it."""
    while isinstance(tree, dict) and "_target_" not in tree and len(tree) == 1 and "error" not in tree:
        tree = next(iter(tree.values()))
    return tree if isinstance(tree, dict) else {"error": "has no _target_"}
