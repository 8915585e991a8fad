"""From a composed Hydra configuration to a case; every mistake becomes one `BadInput` naming its field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import hydra
from hydra.core.global_hydra import GlobalHydra
from hydra.core.object_type import ObjectType
from hydra.core.plugins import Plugins
from omegaconf import DictConfig, OmegaConf, open_dict
from pydantic import ValidationError

from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.ground.errors import BadInput, invalid, unknown_field
from benchbench.mpcc.ready import ReadyMade
from benchbench.nlp.relaxation import Relaxation
from benchbench.nlp.solver import Solver
from benchbench.ocp.kinds import kind_of
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.values import FIELD
from benchbench.planning.case import Case, Guess, ReadyCase, Strategy
from benchbench.planning.margins import NONE
from benchbench.planning.task_hash import task_hash
from benchbench.run import flying, settings, trust
from benchbench.run.choices import PARTS
from benchbench.run.choices import folder as place
from benchbench.run.hydra_errors import EXPECTED, explained
from benchbench.run.making import made
from benchbench.run.numbers import NUMBERS, WORDS, check
from benchbench.run.overrides import implied, implying
from benchbench.run.plugin_choices import SearchPath
from benchbench.run.random_task import drawn
from benchbench.transcription.dynamics import Dynamics

KINDS: dict[str, type | tuple[type, ...]] = {
    "scenario": (dict, ReadyMade), "vehicle": Model, "dynamics": Dynamics, "relaxation": Relaxation, "solver": Solver,
    "strategy": Strategy, "guess": Guess, "certificate": ProblemLimits,
}  # fmt: skip
FAMILIES = tuple(family for family in KINDS if family != "scenario")
FLIGHT = ("vehicle", "dynamics", "guess")
"""Families that play no part in a scenario that comes ready-made as an MPCC."""
FIELDS = (*KINDS, "peer", *flying.FIELDS, *NUMBERS, *WORDS, *settings.NOT_DECISIVE)


def folder() -> str:
    """Absolute path of the configuration, see `choices.folder`. Raises BadInput.

    Plugins and third parties' configuration are on the search path from here on.
    """
    Plugins.instance().register(SearchPath)
    return place()


def choices(family: str) -> list[str]:
    """Names of everything that can be chosen from a family on the search path."""
    if not GlobalHydra.instance().is_initialized():
        with hydra.initialize_config_dir(folder(), version_base="1.3"):
            return choices(family)
    found = GlobalHydra.instance().config_loader().get_group_options(family, ObjectType.CONFIG)
    return sorted(name for name in found if name not in PARTS)


def compose(*overrides: str) -> Case:
    """Return the flight that the same overrides give on the command line, for use from Python.

    Own YAML: "hydra.searchpath=[file:///absolute/folder]". Raises BadInput.
    """
    case = compose_any(*overrides)
    if not isinstance(case, Case):
        raise BadInput("scenario", f"'{case.names['scenario']}' is no flight", "a flight")
    return case


def compose_any(*overrides: str, stored: bool = False) -> Case | ReadyCase:
    """Return the same of any scenario, a flight or an MPCC that comes ready-made. Raises BadInput.

    stored: the overrides stood in a folder of results, so they are data: only installed plugins are made.
    """
    return build(*composed(*overrides, stored=stored))


def composed(*overrides: str, stored: bool = False) -> tuple[DictConfig, dict[str, Any]]:
    """Return the configuration that overrides lead to, and the names of its choices by family. Raises BadInput.

    stored: as in `compose_any`. A family of tasks is the one task that is drawn from it.
    """
    with hydra.initialize_config_dir(folder(), version_base="1.3"):
        try:
            cfg = hydra.compose("config", meant(overrides), return_hydra_config=True)
        except (*EXPECTED, ValueError) as error:
            raise explained(error) from error
    chosen = dict(cfg.hydra.runtime.choices)
    with open_dict(cfg):
        del cfg["hydra"]
    if stored:
        trust.check(OmegaConf.to_container(cfg, resolve=True), "configuration")
    return drawn(cfg), chosen


def meant(overrides: Sequence[str], more: str | None = None) -> list[str]:
    """Return overrides of one run with what they imply; `more` is the user's own folder. Raises what Hydra does."""
    overrides = [*overrides, *flying.flying(overrides, chosen_in_files(overrides, more))]
    if not implying(overrides):  # composing takes longer than all else here
        return overrides
    if not GlobalHydra.instance().is_initialized():
        with hydra.initialize_config_dir(folder(), version_base="1.3"):
            return [*overrides, *implied(overrides, _composed(overrides, more))]
    return [*overrides, *implied(overrides, _composed(overrides, more))]


def chosen_in_files(overrides: Sequence[str], more: str | None = None) -> set[str]:
    """Return what files of the user's own, as in +tuned=best, choose of flights; `more` is the folder they may be in."""
    added = {text: text.lstrip("+").partition("=")[0] for text in overrides if text.startswith("+")}
    own = [text for text, key in added.items() if not {*"./@"} & {*key} and key not in FIELDS]
    own += [text for text in overrides if text.startswith("hydra.searchpath=")]
    if not any(text.startswith("+") and "," not in text for text in own):
        return set()
    if not GlobalHydra.instance().is_initialized():
        with hydra.initialize_config_dir(folder(), version_base="1.3"):
            return chosen_in_files(overrides, more)
    try:
        cfg = _composed(own, more)
    except (*EXPECTED, ValueError):  # what is wrong with it is told where all is composed
        return set()
    return {name for name in flying.FIELDS if cfg.get(name)}


def _composed(overrides: Sequence[str], more: str | None) -> DictConfig:
    own = [f"hydra.searchpath=['file://{Path(more).absolute()}']"] if more else []
    return hydra.compose("config", [*overrides, *own], return_hydra_config=True)


def build(cfg: DictConfig, chosen: Mapping[str, Any]) -> Case | ReadyCase:
    """Make every part of the case; `chosen` are the names of the choices by family. Raises BadInput."""
    try:
        OmegaConf.to_container(cfg, resolve=True)
    except EXPECTED as error:
        raise explained(error) from None
    _check_run(cfg, chosen)
    families = _families(cfg)
    scenario = make(cfg, "scenario")  # before the others are imported: most mistakes are in its numbers
    task = scenario if isinstance(scenario, ReadyMade) else scenario_of(scenario)
    parts = {family: task if family == "scenario" else make(cfg, family) for family in families}
    names = {family: str(chosen.get(family) or "custom") for family in parts if family != "scenario"}
    names["strategy"] = _nested(names["strategy"], chosen)
    how = {
        **{f: parts[f] for f in ("relaxation", "solver", "strategy")}, "limits": parts["certificate"],
        **{key: cfg[key] for key in (*NUMBERS, *WORDS)},
    }  # fmt: skip
    if isinstance(parts["scenario"], ReadyMade):
        ready = parts["scenario"]
        return ReadyCase(
            scenario=ready, names={"scenario": ready.name, **names}, task_hash=task_hash(cfg), **how
        )
    return replace(_flight(parts, names, how), task_hash=task_hash(cfg))


def _nested(strategy: str, chosen: Mapping[str, Any]) -> str:
    """Name of a strategy with those inside it, the outermost first: multistart(polish(relax))."""
    inner = sorted((key for key in chosen if key.startswith("strategy@strategy.")), key=len)
    names = [strategy, *(str(chosen[key]) for key in inner)]
    return "(".join(names) + ")" * len(inner)


def _families(cfg: DictConfig) -> list[str]:
    """The families that this scenario needs a choice from; raises BadInput for another one."""
    if "_target_" not in (cfg.get("scenario") or {}):
        return list(KINDS)
    for family in FLIGHT:
        if cfg.get(family) is not None:
            raise BadInput(
                family, "plays no part in a problem that is no flight", f"~{family}, or no {family}"
            )
    return [family for family in KINDS if family not in FLIGHT]


def _flight(parts: Mapping[str, Any], names: Mapping[str, str], how: Mapping[str, Any]) -> Case:
    if not isinstance(parts["certificate"], Limits):
        raise BadInput(
            "certificate", f"'{names['certificate']}' is for problems that are no flight", "task, race"
        )
    scenario = parts["scenario"]
    return Case(
        scenario=scenario, model=parts["vehicle"], dynamics=parts["dynamics"], guess=parts["guess"],
        names={"scenario": scenario.name, **names}, **how,
    )  # fmt: skip


def scenario_of(values: Mapping[str, Any]) -> Scenario:
    """Make a flight's scenario of its fields. Raises BadInput."""
    kind = kind_of(values)
    try:
        scenario = kind(**{name: value for name, value in values.items() if name != FIELD})
    except ValidationError as error:
        raise invalid("scenario", error, kind.model_fields) from None
    _check_margins(values)
    return scenario


def _check_run(cfg: DictConfig, chosen: Mapping[str, Any]) -> None:
    """Raise BadInput where a family has no choice, a field does not exist, or a number makes no sense."""
    if chosen.get("scenario") in PARTS:
        problem = f"'{chosen['scenario']}' is what other scenarios have in common, not a scenario"
        raise BadInput("scenario", problem, ", ".join(choices("scenario")))
    for family in _families(cfg):
        if not isinstance(cfg.get(family), DictConfig) or (family == "scenario" and not chosen.get(family)):
            plus = "+" if family == "scenario" else ""
            allowed = f"{plus}{family}=NAME with NAME one of {', '.join(choices(family))}"
            raise BadInput(family, "none was chosen", allowed)
    for key in cfg:
        if key not in FIELDS:
            raise unknown_field(str(key), FIELDS)
    check({key: cfg.get(key) for key in (*NUMBERS, *WORDS)})
    if not isinstance(cfg.get("output"), str | int) or cfg.get("output") == "":
        raise BadInput("output", f"{cfg.get('output')!r} was given", "the path of a folder")
    if chosen.get("peer") and chosen.get("strategy") != "peer":
        raise BadInput(
            "peer", f"'{chosen['peer']}' is chosen, but not asked", "strategy=peer beside it, or no peer"
        )
    settings.Settings.of(cfg)


def _check_margins(scenario: Mapping[str, Any]) -> None:
    """Raise BadInput for a margin or an aim of a contact that is neither there nor switched off by null, or a kept one that is none."""
    contacts = scenario.get("contacts") or {}
    for field in ("contact_margin", "aim"):
        for name in scenario.get(field) or {}:
            if contacts and name not in contacts:
                allowed = f"{', '.join(contacts)}; scenario.contacts.NAME=null switches a contact off"
                raise BadInput(f"scenario.{field}.{name}", "there is no such contact", allowed)
    there = [f"{field}.{name}" for field in NONE for name in scenario.get(field) or {}]
    for name in scenario.get("kept_margins") or ():
        if name not in there:
            raise BadInput(
                "scenario.kept_margins", f"there is no margin {name!r}", ", ".join(there) or "none"
            )


def make(cfg: DictConfig, family: str) -> Any:
    """Make the choice of one family. Raises BadInput."""
    return made(cfg, family, KINDS[family])
