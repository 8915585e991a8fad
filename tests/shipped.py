"""Configuration is read and merged once per session: Hydra does both again whenever it composes.

That is half of a composition, and the tests compose a thousand times. What is kept is kept by its content: files of
a test's own are read each time, and merged again when they say something else.
"""

from __future__ import annotations

import pickle
from functools import wraps
from typing import Any

from hydra._internal import defaults_list
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import ConfigRepository
from hydra.core.object_type import ObjectType
from omegaconf import OmegaConf

from benchbench.run.choices import folder

_READ: dict[tuple[str, str, str], bytes] = {}
_MERGED: dict[tuple[Any, ...], bytes] = {}


def compose_once() -> None:
    """Keep what Hydra makes of files in `conf/` and of its own, and of merging them; each composition is given a copy."""
    ConfigRepository.load_config = _kept(ConfigRepository.load_config)
    ConfigLoaderImpl._compose_config_from_defaults_list = _merged(
        ConfigLoaderImpl._compose_config_from_defaults_list
    )
    defaults_list._create_interpolation_map = _looked_up(defaults_list._create_interpolation_map)


def _kept(load: Any) -> Any:
    ours = f"file://{folder()}"

    @wraps(load)
    def kept(self: ConfigRepository, config_path: str) -> Any:
        source = self._find_object_source(config_path, ObjectType.CONFIG)
        path = "" if source is None else source.full_path()
        if path != ours and not path.startswith("pkg://hydra"):
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


def _merged(merge: Any) -> Any:
    @wraps(merge)
    def merged(self: ConfigLoaderImpl, defaults: list[Any], repo: Any) -> Any:
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
