"""From a composed Hydra configuration to a case; every mistake becomes one `BadInput` naming its field."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import hydra
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import InstantiationException
from omegaconf import DictConfig, OmegaConf
from pydantic import ValidationError

from benchbench.case import Case
from benchbench.errors import BadInput, BenchBenchError
from benchbench.scenario import Scenario

FAMILIES = ("vehicle", "dynamics", "relaxation", "solver", "strategy", "guess", "certificate")
HIDDEN = ("handover",)


def folder() -> str:
    """Absolute path of the configuration: $BENCHBENCH_CONF, the installed one, or the checkout's."""
    here = Path(__file__).resolve().parent
    asked = os.environ.get("BENCHBENCH_CONF")
    for candidate in ([Path(asked)] if asked else []) + [here / "conf", here.parent / "conf"]:
        if (candidate / "config.yaml").is_file():
            return str(candidate)
    raise BadInput(
        "BENCHBENCH_CONF", "no folder with a config.yaml found", "the path of benchbench's conf folder"
    )


def scenarios() -> list[str]:
    """Names of all scenarios on the search path."""
    loader = GlobalHydra.instance().config_loader() if GlobalHydra.instance().is_initialized() else None
    names = (
        loader.get_group_options("scenario")
        if loader
        else [p.stem for p in Path(folder(), "scenario").glob("*.yaml")]
    )
    return sorted(n for n in names if n not in HIDDEN)


def compose(*overrides: str) -> Case:
    """Return the case that the same overrides give on the command line, for use from Python."""
    with hydra.initialize_config_dir(folder(), version_base="1.3"):
        cfg = hydra.compose("config", list(overrides), return_hydra_config=True)
        choices = OmegaConf.to_container(cfg.hydra.runtime.choices)
        return build(cfg, dict(choices))  # type: ignore[arg-type]


def build(cfg: DictConfig, choices: Mapping[str, Any]) -> Case:
    """Make every part of the case; raises BadInput."""
    if "scenario" not in cfg:
        raise BadInput(
            "scenario", "none was chosen", f"+scenario=NAME with NAME one of {', '.join(scenarios())}"
        )
    parts = {family: _make(cfg, family) for family in FAMILIES}
    names = {family: str(choices.get(family) or "custom") for family in FAMILIES}
    fields = _make(cfg, "scenario")
    scenario = _checked("scenario", Scenario, **{str(k): v for k, v in fields.items()})
    rest = {key: cfg[key] for key in ("seed", "accuracy", "compile", "time_limit", "iteration_limit")}
    _check_run(rest)
    return Case(
        scenario=scenario, model=parts["vehicle"], limits=parts["certificate"],
        names={"scenario": scenario.name, **names}, **rest,
        **{f: parts[f] for f in ("dynamics", "relaxation", "solver", "strategy", "guess")},
    )  # fmt: skip


def _check_run(rest: Mapping[str, Any]) -> None:
    for key, allowed in {"compile": ("auto", "never"), "accuracy": ("low", "medium", "high")}.items():
        if rest[key] not in allowed:
            raise BadInput(key, f"'{rest[key]}' does not exist", ", ".join(allowed))
    for key in ("time_limit", "iteration_limit", "seed"):
        value = rest[key]
        low = 0 if key == "seed" else 1e-3
        if not isinstance(value, (int, float)) or isinstance(value, bool) or not value >= low:
            raise BadInput(key, f"{value!r} is not usable", f"a number of at least {low:g}")


def _make(cfg: DictConfig, family: str) -> Any:
    try:
        return hydra.utils.instantiate(cfg[family], _convert_="all")
    except InstantiationException as error:
        raise _explained(family, error) from None


def _checked(field: str, kind: type[Scenario], **values: Any) -> Scenario:
    try:
        return kind(**values)
    except ValidationError as error:
        raise _validation(field, error) from None


def _explained(family: str, error: InstantiationException) -> BenchBenchError:
    cause: BaseException | None = error.__cause__
    while cause is not None and not isinstance(cause, (BenchBenchError, ValidationError, TypeError)):
        cause = cause.__cause__
    where = str(error).rpartition("full_key: ")[2].strip() if "full_key: " in str(error) else family
    where = where if where.startswith(family) else f"{family}.{where}"
    if isinstance(cause, BenchBenchError):
        return cause
    if isinstance(cause, ValidationError):
        return _validation(where, cause)
    return BadInput(where, str(cause or error).splitlines()[0])


def _validation(field: str, error: ValidationError) -> BadInput:
    first = error.errors()[0]
    place = ".".join([field, *(str(part) for part in first["loc"])])
    given = (
        ""
        if first["type"] in ("missing", "unexpected_keyword_argument")
        else f", but {first['input']!r} was given"
    )
    return BadInput(place, first["msg"] + given)
