"""A part of a composed configuration is made; every mistake becomes one `BadInput` naming its field."""

from __future__ import annotations

import inspect
from typing import Any

import hydra
from hydra.errors import InstantiationException
from omegaconf import DictConfig, ListConfig, OmegaConf
from pydantic import ValidationError

from benchbench.ground.errors import BadInput, BenchBenchError, invalid, unknown_field
from benchbench.run.hydra_errors import EXPECTED, explained


def made(cfg: DictConfig, place: str, kinds: type | tuple[type, ...]) -> Any:
    """Make what stands at a place of the configuration, an instance of one of `kinds`. Raises BadInput."""
    node = OmegaConf.select(cfg, place)
    try:
        found = hydra.utils.instantiate(node, _convert_="all")
    except InstantiationException as error:
        raise _explained(cfg, place, error) from None
    except EXPECTED as error:
        raise explained(error) from None
    if not isinstance(found, kinds):
        raise BadInput(f"{place}._target_", f"gives a {type(found).__name__}", f"a {_named(kinds)}")
    _check_names(node, place)
    return found


def _named(kinds: type | tuple[type, ...]) -> str:
    return " or ".join(kind.__name__ for kind in (kinds if isinstance(kinds, tuple) else (kinds,)))


def _check_names(node: Any, place: str) -> None:
    """Raise BadInput for a key that its class does not take; classes that ignore what they do not know exist."""
    if isinstance(node, ListConfig):
        for i, item in enumerate(node):
            _check_names(item, f"{place}.{i}")
    if not isinstance(node, DictConfig):
        return
    names = _parameters(node)
    for key in map(str, node):
        if names and key not in names and not key.startswith("_"):
            raise unknown_field(f"{place}.{key}", names)
        _check_names(node[key], f"{place}.{key}")


def _parameters(node: DictConfig) -> list[str]:
    """Names that the class of a configuration node takes; none if it has no class or takes any name."""
    if "_target_" not in node:
        return []
    parameters = inspect.signature(hydra.utils.get_class(node["_target_"])).parameters
    if any(p.kind is p.VAR_KEYWORD for p in parameters.values()):
        return []
    return list(parameters)


def _explained(cfg: DictConfig, family: str, error: InstantiationException) -> BenchBenchError:
    cause: BaseException = error
    while cause.__cause__ is not None and not isinstance(cause, (BenchBenchError, ValidationError)):
        cause = cause.__cause__
    where = str(error).rpartition("full_key: ")[2].strip() if "full_key: " in str(error) else family
    where = where if where.startswith(family) else f"{family}.{where}"
    if isinstance(cause, BenchBenchError):
        return cause
    if isinstance(cause, ValidationError):
        here = OmegaConf.select(cfg, where) if len(cause.errors()[0]["loc"]) == 1 else None
        return invalid(where, cause, _parameters(here) if isinstance(here, DictConfig) else ())
    unknown = str(error).startswith("Error locating target") or cause is error
    if unknown or isinstance(cause, (ImportError, AttributeError)):
        target = OmegaConf.select(cfg, f"{where}._target_")
        return BadInput(f"{where}._target_", f"'{target}' cannot be loaded: {str(cause).splitlines()[0]}")
    return BadInput(where, str(cause).splitlines()[0])
