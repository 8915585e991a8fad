"""What Hydra, OmegaConf and the YAML reader refuse, as one `BadInput` in the user's words."""

from __future__ import annotations

import re

from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf import DictConfig
from omegaconf.errors import (
    ConfigAttributeError,
    ConfigKeyError,
    MissingMandatoryValue,
    OmegaConfBaseException,
)
from yaml import YAMLError  # type: ignore[import-untyped]

from benchbench.ground.errors import BadInput, BenchBenchError, unknown_choice, unknown_field
from benchbench.run.choices import PARTS

EXPECTED = (BenchBenchError, HydraException, OmegaConfBaseException, YAMLError)
"""Errors about the input, not about the program."""

# Hydra's text -> (field, problem, allowed); {0}, {1} are the groups of the pattern.
_RULES = (
    (r"Could not override '([^']+)'\. No match in the defaults list\.\s+To append .* use (\S+)",
     "{0}", "is not in the defaults and needs a plus sign", "{1}"),
    (r"Multiple values for ([^ ]+)\.", "{0}", "is chosen twice", "one choice"),
    (r"Could not (?:override|delete) '([^']+)'", "{0}", "does not exist", ""),
    (r"Could not delete from config\. '([^']+)' does not exist", "{0}", "does not exist", ""),
    (r"^(\S+) appears more than once in the final defaults list",
     "{0}", "is chosen twice", "{0}=NAME without the plus sign replaces the choice"),
    (r"Could not append to config\. An item is already at '([^']+)'",
     "{0}", "exists already", "{0}=VALUE without the plus sign"),
    (r"Ambiguous value for argument '\+*([^=']+)=([^']*)'",
     "{0}", "got several values: {1}", "one value, or -m in front to run them all; a list is written [1,2]"),
    (r"Sweep parameters '\+*([^=']+)=([^']*)' requires", "{0}", "got several values: {1}", "-m in front to run them all"),
    (r"Sweeping over Hydra's configuration is not supported : '\+*([^=']+)=", "{0}", "cannot have several values", ""),
    (r"(Config group override) must be a string", "a choice", "is null or a number, which is no name", "CHOICE=NAME"),
    (r"config group '([^']+)' does not exist", "{0}", "there is no such choice", ""),
    (r"Additional config directory '([^']+)' not found", "--config-dir", "there is no folder '{0}'", "an existing folder"),
)  # fmt: skip


def explained(error: BaseException) -> BenchBenchError:
    """Return an error of one of the types in `EXPECTED` as ours; ours stay as they are."""
    match error:
        case BenchBenchError():
            return error
        case MissingConfigException():
            return _missing(error)
        case OverrideParseException():
            return BadInput(
                f"'{error.override}'", "cannot be read", "FIELD=VALUE, for example +scenario=circle"
            )
        case YAMLError():
            return _no_yaml(error)
    cause = error if isinstance(error, OmegaConfBaseException) else error.__cause__
    if isinstance(cause, (ConfigAttributeError, ConfigKeyError)) and isinstance(
        cause.parent_node, DictConfig
    ):
        return _absent(cause)
    if isinstance(cause, MissingMandatoryValue) and cause.full_key:
        return BadInput(cause.full_key, "is not given and has no default", f"{cause.full_key}=VALUE")
    if isinstance(cause, OmegaConfBaseException):
        return BadInput(cause.full_key or "configuration", _first_line(cause))
    for pattern, *parts in _RULES:
        if found := re.search(pattern, str(error)):
            return BadInput(*(part.format(*found.groups()) for part in parts))
    return BadInput("configuration", _first_line(error))


def _absent(cause: ConfigAttributeError | ConfigKeyError) -> BadInput:
    parent = cause.parent_node._get_full_key(None)
    place = f"{parent}.{cause.key}" if parent else str(cause.key)
    if place == "scenario":
        return BadInput("scenario", "none was chosen", "+scenario=NAME")
    names = [str(name) for name in cause.parent_node if name not in ("hydra", "_target_")]
    if parent == "scenario" and "_target_" not in cause.parent_node:
        return _not_in_scenario(str(cause.key), cause.parent_node)
    add = f"+{place}=VALUE to add what the YAML leaves out" if parent else ""
    if names or not parent:
        return unknown_field(place, names, add)
    chosen = str(cause.parent_node.get("_target_", "")).rpartition(".")[2]
    return BadInput(
        place, f"'{chosen}' has no such field" if chosen else "does not exist", f"another {parent}, or {add}"
    )


def _not_in_scenario(name: str, scenario: DictConfig) -> BadInput:
    """A field of the scenario that its YAML does not have: one that its kind knows needs a plus sign, another one is none."""
    from benchbench.ocp.kinds import kind_of

    fields = kind_of({str(key): None for key in scenario} | {"kind": scenario.get("kind")}).model_fields
    place = f"scenario.{name}"
    if name in fields:
        inside = f", or +{place}.NAME=VALUE" if fields[name].default_factory is dict else ""
        problem = "is not in the YAML of this scenario, so it needs a plus sign"
        return BadInput(place, problem, f"+{place}=VALUE{inside}")
    return unknown_field(place, fields)


def _missing(error: MissingConfigException) -> BadInput:
    group, _, name = (error.missing_cfg_file or "").rpartition("/")
    options = [option for option in error.options or () if option not in PARTS]
    parent = re.match(r"In '([^']+)'", str(error))
    if parent and parent[1] != "config":
        problem = f"builds on '{error.missing_cfg_file}', which does not exist"
        return BadInput(parent[1], problem, ", ".join(options))
    if not group:
        return BadInput("--config-name", f"there is no '{name}.yaml' on the search path")
    if not options:
        return BadInput(group, f"there is no choice '{name}'", "what an installed package brings; none does")
    return unknown_choice(group, name, options)


def _no_yaml(error: YAMLError) -> BadInput:
    mark = getattr(error, "problem_mark", None)
    place = f"{mark.name}, line {mark.line + 1}" if mark else "configuration"
    return BadInput(place, f"is no YAML: {getattr(error, 'problem', None) or _first_line(error)}")


def _first_line(error: BaseException) -> str:
    """The part of a text that says what is wrong; advice to programmers is cut off."""
    text = str(error).strip().splitlines()
    return re.sub(r",? set env var HYDRA_FULL_ERROR.*", "", text[0]) if text else type(error).__name__
