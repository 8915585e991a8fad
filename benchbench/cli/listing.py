"""`benchbench plugins`: what can be chosen, whether it works here, where it comes from; `plugins solver=NAME`: its options."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from importlib.metadata import packages_distributions
from typing import Any, get_args

import hydra
from hydra.core.global_hydra import GlobalHydra
from omegaconf import OmegaConf

from benchbench.ground import registry
from benchbench.ground.errors import BadInput
from benchbench.ground.families import FLOWN
from benchbench.nlp.availability import Availability, begin, works
from benchbench.nlp.solver import Accuracy, Setup
from benchbench.ocp.kinds import OWN as OWN_KINDS
from benchbench.run import config
from benchbench.run.choice import choice

OWN = "benchbench"


@dataclass(frozen=True)
class Row:
    """One choice: origin is "built-in" or the name of the distribution, `text` what it is and its paper."""

    name: str
    here: Availability
    origin: str
    text: str

    def line(self, widths: tuple[int, int]) -> str:
        """One line of the list."""
        here = "" if self.here.works else f"NOT AVAILABLE HERE: {self.here.reason}  "
        return f"  {self.name:<{widths[0]}}  {self.origin:<{widths[1]}}  {here}{self.text}"


def listing(arguments: Sequence[str], hear: Callable[[str], None] = lambda _: None) -> Iterator[str]:
    """Yield the lines of `benchbench plugins ARGUMENTS`; `hear` is told what is tried. Raises BadInput for what does not exist."""
    if not arguments:
        yield from _everything(hear)
        return
    family, _, name = arguments[0].partition("=")
    if family not in (*config.FAMILIES, "peer", *FLOWN) or name not in config.choices(family):
        raise BadInput(
            "plugins", f"'{arguments[0]}' does not exist", " ".join(f"{f}=NAME" for f in config.FAMILIES)
        )
    yield inspect.cleandoc(_class(_composed(family, name)).__doc__ or "")
    if family == "solver":
        yield ""
        yield from _options(config.compose("+scenario=static", *arguments))


def _everything(hear: Callable[[str], None]) -> Iterator[str]:
    begin()
    with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        found = {family: _family(family, hear) for family in (*config.FAMILIES, "peer", *FLOWN)}
    found |= {family: _registered(family) for family in ("contacts", "motions", "task_families")}
    found["scenarios"] = [*_own_kinds(), *_registered("scenarios")]
    widths = tuple(
        max(len(getattr(row, k)) for rows in found.values() for row in rows) for k in ("name", "origin")
    )
    for family, rows in found.items():
        yield family
        yield from (row.line(widths) for row in rows)  # type: ignore[arg-type]


def _tried(name: str, fields: Any, here: Availability, hear: Callable[[str], None]) -> Availability:
    """Whether a solver works, tried in a process of its own."""
    hear(f"trying solver={name}")
    return works(fields) if here.works else here


def _family(family: str, hear: Callable[[str], None]) -> list[Row]:
    """Every choice of a configuration group; solvers are tried in child processes, two at a time."""
    configs = {name: _composed(family, name) for name in config.choices(family)}
    here = {name: _importable(fields) for name, fields in configs.items()}
    if family == "solver":
        with ThreadPoolExecutor(2) as pool:
            tried = pool.map(lambda name: _tried(name, configs[name], here[name], hear), configs)
            here = dict(zip(configs, tried, strict=True))
    if family == "peer":
        here = {name: _peer(fields) if here[name].works else here[name] for name, fields in configs.items()}
    return [Row(name, here[name], _origin(fields), _text(fields)) for name, fields in configs.items()]


def _peer(fields: dict[str, Any]) -> Availability:
    missing = hydra.utils.instantiate(fields, _convert_="all").missing()
    return Availability(not missing, missing)


def _registered(family: str) -> list[Row]:
    return [
        Row(p.name, Availability(not p.error, p.error), _distribution(p.distribution), p.summary)
        for p in registry.installed(family)
    ]


def _own_kinds() -> list[Row]:
    """Kinds of scenarios that are part of the core."""
    texts = {name: (kind.__doc__ or "").partition("\n")[0] for name, kind in OWN_KINDS.items()}
    return [Row(name, Availability(True), "built-in", text) for name, text in texts.items()]


def _options(case: Any) -> Iterator[str]:
    """What accuracy and limits become in a solver's own option names."""
    columns = {
        accuracy: case.solver.native_options(Setup(case.time_limit, case.iteration_limit, accuracy))
        for accuracy in get_args(Accuracy)
    }
    names = list(next(iter(columns.values())))
    width = max(len(name) for name in ("option", *names))
    yield f"{'option':<{width}}  " + "  ".join(f"accuracy={accuracy:<8}" for accuracy in columns)
    for name in names:
        yield f"{name:<{width}}  " + "  ".join(f"{options[name]!s:<17}" for options in columns.values())


def _composed(family: str, name: str) -> dict[str, Any]:
    if not GlobalHydra.instance().is_initialized():
        with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
            return _composed(family, name)
    fields = OmegaConf.to_container(choice(family, name), resolve=True)
    return {str(k): v for k, v in fields.items()}  # type: ignore[union-attr]


def _class(fields: dict[str, Any]) -> type:
    return hydra.utils.get_class(fields["_target_"])


def _importable(fields: dict[str, Any]) -> Availability:
    try:
        _class(fields)
    except Exception as error:  # noqa: BLE001  # importing somebody's module can raise anything
        return Availability(False, str(error).strip().splitlines()[-1])
    return Availability(True)


def _text(fields: dict[str, Any]) -> str:
    """First line of the docstring; a class that serves many backends carries their reference as a field."""
    if not _importable(fields).works:
        return ""
    return str(fields.get("reference") or (_class(fields).__doc__ or "").strip().partition("\n")[0])


def _origin(fields: dict[str, Any]) -> str:
    """Who registers the class, else whose package it is in."""
    target = str(fields.get("_target_", ""))
    package = target.partition(".")[0]
    return _distribution(_registrars().get(target) or (_distributions().get(package) or [package])[0])


@cache
def _registrars() -> dict[str, str]:
    """Names of the distributions that register plugins, by class."""
    everything = (
        entry
        for family in registry.FAMILIES
        for group in registry.entries(family).values()
        for entry in group
    )
    return {entry.value.replace(":", "."): entry.dist.name for entry in everything if entry.dist}


_distributions = cache(packages_distributions)  # reads the metadata of everything that is installed


def _distribution(name: str) -> str:
    return "built-in" if name == OWN else name
