"""Every installed plugin is a choice: its entry point makes the configuration node that a YAML file would.

The node of `benchbench.relaxations: scholtes = "package.module:Scholtes"` is `relaxation/scholtes`: the class as
`_target_`, and its parameters with their defaults. A YAML file of that name, wherever it is on the search path, is
taken instead. To list the names reads metadata only; a plugin is imported when it is chosen.
"""

from __future__ import annotations

import dataclasses
import inspect
from importlib.metadata import EntryPoint
from itertools import chain
from typing import Any

from hydra.core.object_type import ObjectType
from hydra.plugins.config_source import ConfigLoadError, ConfigResult, ConfigSource
from hydra.plugins.search_path_plugin import SearchPathPlugin
from omegaconf import DictConfig, OmegaConf

from benchbench.ground import registry
from benchbench.ground.errors import BadInput
from benchbench.run.choices import EVERY

PLACES = {
    "scenario/contact": "_global_.scenario.contacts.{}", "scenario/motion": "_global_.scenario.target",
    "scenario/obstacle": "_global_.scenario.obstacles.{}", "scenario/cost": "_global_.scenario.costs.{}",
}  # fmt: skip
"""Where in the configuration the choices of a group stand, with their name; others stand where their group does."""
SCHEME = "plugins"
Names = list[str]


class PluginSource(ConfigSource):
    """Configuration that comes from entry points, as other configuration comes from files."""

    @staticmethod
    def scheme() -> str:
        """What its place on the search path starts with."""
        return SCHEME

    def available(self) -> bool:
        """Always there."""
        return True

    def is_group(self, config_path: str) -> bool:
        """Whether plugins are chosen from this group, or from one inside it."""
        return any(f"{group}/".startswith(f"{config_path}/".lstrip("/")) for _, group in EVERY)

    def is_config(self, config_path: str) -> bool:
        """Whether a plugin of this name is installed."""
        return bool(_entries(config_path))

    def list(self, config_path: str, results_filter: ObjectType | None) -> Names:
        """Names of the plugins, and of the groups, in a group."""
        names: set[str] = set()
        if results_filter in (None, ObjectType.CONFIG):
            names.update(*(registry.entries(f) for f, group in EVERY if group == config_path))
        if results_filter in (None, ObjectType.GROUP):
            inside = f"{config_path}/".lstrip("/")
            below = (group.removeprefix(inside) for _, group in EVERY if group.startswith(inside))
            names.update(group.partition("/")[0] for group in below)
        return sorted(names)

    def load_config(self, config_path: str) -> ConfigResult:
        """Return the node of a plugin. Raises BadInput for a name that two packages gave to different classes."""
        found = _entries(config_path)
        group, _, name = config_path.removesuffix(".yaml").rpartition("/")
        if not found:
            raise ConfigLoadError(f"there is no plugin {config_path}")
        if len(found) > 1:
            both = " and ".join(sorted(entry.value for entry in found))
            raise BadInput(group, f"'{name}' is registered for {both}", "one of them installed")
        place = PLACES[group].format(name) if group in PLACES else None
        return ConfigResult(self.provider, self.full_path(), _node(found[0]), {"package": place})


class SearchPath(SearchPathPlugin):
    """Adds what third parties bring: config packages of the entry point group `benchbench.conf`, then plugins."""

    def manipulate_search_path(self, search_path: Any) -> None:
        """Append pkg://<package> for each of them, and keep the plugins behind all YAML that is added later."""
        for entry in chain.from_iterable(registry.entries("conf").values()):
            search_path.append(provider=f"benchbench:{entry.name}", path=f"pkg://{entry.value}")
        search_path.append(provider="benchbench", path=f"{SCHEME}://")
        search_path.config_search_path = _YamlFirst(search_path.get_path())


class _YamlFirst(list[Any]):
    """Places on a search path: what is added with --config-dir or hydra.searchpath comes before the plugins.

    Hydra wants its own last place, the schema, behind them.
    """

    def append(self, place: Any) -> None:
        self.insert(len(self), place)

    def insert(self, index: Any, place: Any) -> None:
        super().insert(index, place)
        self.sort(key=lambda p: (p.provider == "schema", p.path.startswith(f"{SCHEME}:")))


def _entries(config_path: str) -> tuple[EntryPoint, ...]:
    group, _, name = config_path.removesuffix(".yaml").rpartition("/")
    family = next((family for family, where in EVERY if where == group), None)
    return registry.entries(family).get(name, ()) if family else ()


def _node(entry: EntryPoint) -> DictConfig:
    """The class and its parameters; of one that cannot be loaded only its name, so that building it says why."""
    target = {"_target_": f"{entry.module}.{entry.attr}"}
    try:
        kind = entry.load()
        return OmegaConf.create(target | (options(kind) if isinstance(kind, type) else {}))
    except Exception:  # noqa: BLE001  # importing somebody's module can raise anything
        return OmegaConf.create(
            target, flags={"struct": False}
        )  # its fields are not known, so any may be set


def options(kind: type) -> dict[str, Any]:
    """Return the parameters of a class with their defaults, `???` where there is none.

    What starts with an underscore, and a default that YAML cannot say, is left out.
    """
    fields = dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ()
    made = {f.name: f.default_factory() for f in fields if f.default_factory is not dataclasses.MISSING}
    defaults = {
        name: "???" if parameter.default is parameter.empty else made.get(name, parameter.default)
        for name, parameter in inspect.signature(kind).parameters.items()
        if parameter.kind not in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
    }
    return {name: value for name, value in defaults.items() if name[0] != "_" and _plain(value)}


def _plain(value: Any) -> bool:
    """Whether YAML can say it."""
    if isinstance(value, dict):
        return all(map(_plain, value.values()))
    if isinstance(value, list | tuple):
        return all(map(_plain, value))
    return value is None or type(value) in (bool, int, float, str)
