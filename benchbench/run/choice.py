"""One choice of a configuration group, as its file or its plugin says it."""

from __future__ import annotations

import hydra
from hydra.core.global_hydra import GlobalHydra
from omegaconf import DictConfig, OmegaConf

from benchbench.run.config import FAMILIES


def choice(group: str, name: str) -> DictConfig:
    """Return the fields of a choice, while Hydra is initialised; alone where the program has no such choice by itself.

    Raises what Hydra does: files can be wrong in any way.
    """
    alone = _alone(f"{group}/{name}")
    if alone is not None:
        return alone
    if group in FAMILIES:
        return hydra.compose("config", [f"{group}={name}"])[group]  # it may change other choices
    return hydra.compose(f"{group}/{name}")


def _alone(path: str) -> DictConfig | None:
    """What a file or a plugin says by itself: composing takes a tenth of a second, and there are many files."""
    for source in GlobalHydra.instance().config_loader().get_sources():
        if source.is_config(path):
            found = source.load_config(path).config
            if (
                isinstance(found, DictConfig)
                and "defaults" not in found
                and "${" not in OmegaConf.to_yaml(found)
            ):
                return found
            return None
    return None
