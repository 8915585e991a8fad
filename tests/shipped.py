"""Configuration is read, listed and merged once per session: Hydra does all of it again whenever it composes.

That is most of a composition, and the tests compose a thousand times. What is kept is kept by its content: files of
a test's own are read each time, and merged again when they say something else. Where nothing but the shipped files
is on the search path, the choices among them say which are merged, and how.
"""

from __future__ import annotations

import copy
import pickle
import sys
from functools import wraps
from types import SimpleNamespace
from typing import Any

from hydra._internal import config_loader_impl, defaults_list
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import ConfigRepository
from hydra.core.object_type import ObjectType
from omegaconf import OmegaConf

from benchbench.run.choices import folder

_READ: dict[tuple[str, str, str], bytes] = {}
_LISTED: dict[tuple[Any, ...], bytes] = {}
_MERGED: dict[tuple[Any, ...], bytes] = {}
SHIPPED = (f"file://{folder()}", "pkg://hydra", "plugins://", "structured://")


class _Listed(list[Any]):
    """A list of defaults that knows from which choices it was made."""

    choices: tuple[Any, ...] | None = None


def compose_once() -> None:
    """Keep what Hydra makes of files in `conf/` and of its own, and of merging them; each composition is given a copy."""
    ConfigRepository.load_config = _kept(ConfigRepository.load_config)
    ConfigRepository.__deepcopy__ = lambda self, _: copy.copy(
        self
    )  # its sources are never changed, only replaced
    config_loader_impl.create_defaults_list = _listed(defaults_list.create_defaults_list)
    ConfigLoaderImpl._compose_config_from_defaults_list = _merged(
        ConfigLoaderImpl._compose_config_from_defaults_list
    )
    defaults_list._create_interpolation_map = _looked_up(defaults_list._create_interpolation_map)


def _kept(load: Any) -> Any:
    @wraps(load)
    def kept(self: ConfigRepository, config_path: str) -> Any:
        source = self._find_object_source(config_path, ObjectType.CONFIG)
        path = "" if source is None else source.full_path()
        if not path.startswith(SHIPPED[:2]):
            return load(self, config_path)
        key = (path, source.provider, config_path)
        if key not in _READ:
            _READ[key] = pickle.dumps(
                load(self, config_path)
            )  # a copy by pickle takes a seventh of a deep one
        found = pickle.loads(_READ[key])
        found.kept = key
        return found

    return kept


def _listed(make: Any) -> Any:
    @wraps(make)
    def listed(
        repo: Any, config_name: str | None, overrides_list: list[Any], prepend_hydra: bool, skip_missing: bool
    ) -> Any:
        def whole() -> Any:
            return make(repo, config_name, overrides_list, prepend_hydra, skip_missing)

        places = tuple(source.full_path() for source in repo.get_sources())
        if not all(place.startswith(SHIPPED) for place in places):
            return whole()
        given = [override for override in overrides_list if not override.is_sweep_override()]
        fields = [o for o in given if isinstance(o.value(), dict) or not repo.group_exists(o.key_or_group)]
        choices = tuple(o.input_line for o in given if all(o is not field for field in fields))
        key = (places, tuple(sys.path), config_name, prepend_hydra, skip_missing, choices)
        if key not in _LISTED:
            made = whole()
            _LISTED[key] = pickle.dumps((made.defaults, made.overrides.known_choices))
        kept, known = pickle.loads(_LISTED[key])
        defaults = _Listed(kept)
        defaults.choices = key
        return SimpleNamespace(
            defaults=defaults, config_overrides=fields, overrides=SimpleNamespace(known_choices=known)
        )

    return listed


def _merged(merge: Any) -> Any:
    @wraps(merge)
    def merged(self: ConfigLoaderImpl, defaults: list[Any], repo: Any) -> Any:
        choices = getattr(defaults, "choices", None)
        if choices is not None:
            if choices not in _MERGED:
                _MERGED[choices] = pickle.dumps(merge(self, list(defaults), repo))
            return pickle.loads(_MERGED[choices])
        loaded = [(default.package, repo.load_config(default.config_path)) for default in defaults]
        key = tuple(
            (package, getattr(f, "kept", None) or pickle.dumps((f.header, f.config))) for package, f in loaded
        )
        if key not in _MERGED:
            _MERGED[key] = pickle.dumps(merge(self, defaults, repo))
        return pickle.loads(_MERGED[key])

    return merged


def _looked_up(choices: Any) -> Any:
    """What names in lists of defaults may refer to is only made for those that refer to something."""
    nothing = OmegaConf.create()

    @wraps(choices)
    def looked_up(overrides: Any, defaults: list[Any], self_added: bool) -> Any:
        return choices(overrides, defaults, self_added) if "${" in repr(defaults) else nothing

    return looked_up
