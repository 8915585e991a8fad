"""The configuration of a run, read back from its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import YAMLError  # type: ignore[import-untyped]

PLACES = ("config.yaml", ".hydra/config.yaml")
"""Where it lies: with a plan, and where Hydra puts it before the run begins."""


def configuration(folder: Path | None) -> dict[str, Any] | None:
    """Return the composed configuration of the run in `folder` as plain values, None where there is none."""
    for place in PLACES if folder is not None else ():
        try:
            values = OmegaConf.to_container(OmegaConf.load(Path(folder or "", place)), resolve=True)
        except (OSError, ValueError, YAMLError, OmegaConfBaseException):
            continue
        if isinstance(values, dict):
            return {str(key): value for key, value in values.items()}
    return None
