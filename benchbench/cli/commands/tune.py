"""`benchbench tune SPACE.yaml [OVERRIDE ...]`: search fields with Optuna."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput

SETTINGS = ("study_name", "storage", "n_trials", "objectives", "sampler", "seed", "prune", "over")
PARTS = ("space", "problems", "fixed", *SETTINGS)

EPILOG = """Short for -m hydra/sweeper=optuna with everything in one file: the fields to search, the tasks that every trial plans, and the
study. A study goes on where it stopped. docs/tuning.md says what can stand in the file.

examples
  benchbench tune examples/tuning/polish.yaml
  benchbench tune examples/tuning/schedule.yaml hydra.sweeper.n_trials=40 solver=uno
"""


def run(arguments: Sequence[str]) -> list[str]:
    """Return what it is short for; raises BadInput."""
    asked, more = parser().parse_known_args(arguments)
    return ["-m", *overrides(asked.space), *more]


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "tune",
        "Search fields of the configuration with Optuna; certified plans alone count.",
        EPILOG,
        overrides=True,
    )
    takes.add_argument("space", type=Path, metavar="SPACE.yaml", help="what is searched, on which tasks")
    return takes


def overrides(path: Path) -> list[str]:
    """Return what the file says as overrides of the main command. Raises BadInput."""
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException
    from yaml import YAMLError  # type: ignore[import-untyped]

    try:
        told: Any = OmegaConf.to_container(OmegaConf.load(path))
    except OSError as error:
        raise BadInput(
            str(path), f"cannot be read: {error.strerror}", "a YAML file with a search space"
        ) from None
    except (YAMLError, OmegaConfBaseException, ValueError, RecursionError) as error:
        raise BadInput(str(path), f"is no YAML: {' '.join(str(error).split())[:160]}") from None
    if not isinstance(told, dict) or not told.get("space"):
        raise BadInput(
            f"{path}: space", "is missing", "fields and what they may be, as in N: range(20,100,10)"
        )
    for key in told:
        if key not in PARTS:
            raise BadInput(f"{path}: {key}", "does not exist", ", ".join(PARTS))
    problems = _mapping(path, told, "problems")
    found = ["hydra/sweeper=optuna"]
    found += [f"hydra.sweeper.{key}={_text(told[key])}" for key in SETTINGS if key in told]
    if "over" not in told and problems:
        found.append(f"hydra.sweeper.over={_text([key.lstrip('+') for key in problems])}")
    found += [f"{key}=choice({','.join(map(_text, _listed(value)))})" for key, value in problems.items()]
    found += [f"{key}={_text(value)}" for key, value in _mapping(path, told, "fixed").items()]
    found += [f"{key}={_text(value)}" for key, value in _mapping(path, told, "space").items()]
    return found


def _mapping(path: Path, told: dict[Any, Any], part: str) -> dict[str, Any]:
    value = told.get(part) or {}
    if not isinstance(value, dict):
        raise BadInput(f"{path}: {part}", f"{value!r} was given", "a mapping from fields to values")
    return {f"{key!s}": entry for key, entry in value.items()}


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _text(value: Any) -> str:
    if isinstance(value, list):
        return f"[{','.join(map(_text, value))}]"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return str(value)
