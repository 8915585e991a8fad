"""Configuration that is shipped is read once per session: Hydra reads every file again whenever it composes.

That is a third of a composition, and the tests compose a thousand times. Files of a test's own are read each time.
"""

from __future__ import annotations

import pickle
from functools import wraps
from typing import Any

from hydra._internal.config_repository import ConfigRepository
from hydra._internal.core_plugins.file_config_source import FileConfigSource
from hydra._internal.core_plugins.importlib_resources_config_source import ImportlibResourcesConfigSource
from hydra.core.object_type import ObjectType

from benchbench.run.choices import folder

_READ: dict[tuple[str, str, str], bytes] = {}


def read_once() -> None:
    """Keep what Hydra makes of files in `conf/` and of its own, from here on; each composition is given a copy."""
    load = ConfigRepository.load_config
    ours = f"file://{folder()}"

    @wraps(load)
    def kept(self: ConfigRepository, config_path: str) -> Any:
        source = self._find_object_source(config_path, ObjectType.CONFIG)
        path = "" if source is None else source.full_path()
        hydras = isinstance(source, ImportlibResourcesConfigSource)
        if not hydras and not (isinstance(source, FileConfigSource) and path == ours):
            return load(self, config_path)
        key = (path, source.provider, config_path)
        if key not in _READ:
            _READ[key] = pickle.dumps(
                load(self, config_path)
            )  # a copy by pickle takes a seventh of a deep one
        return pickle.loads(_READ[key])

    ConfigRepository.load_config = kept
