"""A case as `config.compose` makes it, where what is tested comes after: choices are composed once per session.

Hydra composes choices first and sets fields afterwards, so that the fields of a test are set on what was kept, by the
same function. Whatever is refused, implied or drawn goes the whole way, as do all tests of the configuration itself.
"""

from __future__ import annotations

import pickle
import re
from functools import cache
from typing import Any

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import DictConfig

from benchbench.planning.case import Case
from benchbench.run import config
from benchbench.run.overrides import implying

FIELD = re.compile(r"\+*(?:(?!hydra)\w+(?:\.\w+)+|seed|time_limit|iteration_limit|accuracy|compile)=")
WHOLE = ("random_", "searchpath", "${")


def composed(*overrides: str) -> tuple[DictConfig, dict[str, Any]]:
    """Return what `config.composed` does."""
    fields = [o for o in overrides if FIELD.match(o)]
    if implying(overrides) or any(part in o for o in overrides for part in WHOLE):
        return config.composed(*overrides)
    cfg, chosen = pickle.loads(_choices(*(o for o in overrides if not FIELD.match(o))))
    try:
        ConfigLoaderImpl._apply_overrides_to_config(OverridesParser.create().parse_overrides(fields), cfg)
    except Exception:  # noqa: BLE001  # let who tells mistakes tell this one
        return config.composed(*overrides)
    return cfg, chosen


def case_of(*overrides: str) -> Case:
    """Return what `config.compose` does, for flights."""
    case = config.build(*composed(*overrides))
    assert isinstance(case, Case)
    return case


@cache
def _choices(*chosen: str) -> bytes:
    return pickle.dumps(config.composed(*chosen))
