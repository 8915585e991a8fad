"""Names of what was compared: the method and the problem of each run, no longer than they must be."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from typing import Any

import pandas as pd

from benchbench.storage.settings import Settings

METHOD = ("dynamics", "relaxation", "solver", "strategy", "guess")
PROBLEM = ("scenario", "vehicle")
NUMBERS = {"intervals": "N", "kappa_init": "κ", "seed": "seed"}
"""Columns of the table that tell problems apart, and how they are written."""
NEITHER = (
    "output",
    "on_step",
    "workers",
    "rerun",
    "hard_limit",
    "memory_limit_mb",
    "seed",
    "time_limit",
    "repeats",
    "picture",
    "flights",
    "target_success",
)
"""Fields of the configuration that are no part of a name: those that decide nothing (`run/settings.py`, above this room), and two more."""


def name_runs(runs: pd.DataFrame, settings: Sequence[Settings | None]) -> pd.DataFrame:
    """Return the runs with the columns `method`, `task` and `problem` (a task at one N and kappa_init) added.

    A choice is named where it is not the same in all runs, and so is an option in which runs of the same
    choice differ. settings: the configuration of each run, None where it is not known.
    """
    choices = {family: _with_options(runs, settings, family) for family in (*METHOD, *PROBLEM)}
    kinds = ["flight" if vehicle else "" for vehicle in choices["vehicle"]]  # they have other defaults
    general = _within(kinds, settings, lambda name: "." not in name and name not in NEITHER)
    judged = _within(choices["scenario"], settings, lambda name: name.startswith("certificate."))
    method = _join([*_varying({f: choices[f] for f in METHOD}, ("relaxation", "solver")), general])
    task = _join([*_varying({f: choices[f] for f in PROBLEM}, ("scenario",)), judged])
    numbers = [
        [_number(label, _size(value, one, column)) for value, one in zip(runs[column], settings, strict=True)]
        for column, label in NUMBERS.items()
    ]
    keep = numbers[:2] + ([numbers[2]] if len(set(numbers[2])) > 1 else [])
    problem = _join([task, *keep], ", ")
    return runs.assign(method=method, task=task, problem=problem)


def _with_options(runs: pd.DataFrame, settings: Sequence[Settings | None], family: str) -> list[str]:
    """Name of the choice of each run, with the options in which runs of the same choice differ; "" for one that played no part."""
    names = [_name(name, one, family) for name, one in zip(runs[family], settings, strict=True)]
    texts = _within(names, settings, lambda name: _optional(name, family))
    return [f"{name} ({text})" if name and text else name for name, text in zip(names, texts, strict=True)]


def _name(name: Any, one: Settings | None, family: str) -> str:
    """What the table says; a run whose configuration has nothing of a family, as that of an MPCC that is no flight, needs no name."""
    if isinstance(name, str):
        return name
    return "unknown" if one is None or any(key.startswith(f"{family}.") for key in one) else ""


def _within(names: Sequence[str], settings: Sequence[Settings | None], wanted: Any) -> list[str]:
    """For each run, its values of the wanted fields that differ among the runs of the same name."""
    texts = [""] * len(names)
    for name in set(names):
        same = [i for i, other in enumerate(names) if other == name]
        for i, text in zip(same, options(settings, same, wanted), strict=True):
            texts[i] = text
    return texts


def _optional(name: str, family: str) -> bool:
    section, _, option = name.partition(".")
    return section == family and option not in ("name", *NUMBERS)


def options(
    settings: Sequence[Settings | None], among: Sequence[int], wanted: Callable[[str], bool]
) -> list[str]:
    """For each of the runs `among`, its values of the wanted fields that differ among them."""
    known = [settings[i] for i in among]
    fields = sorted(filter(wanted, set().union(*(one for one in known if one is not None))))
    differ = [f for f in fields if len({str(one.get(f)) for one in known if one is not None}) > 1]
    short = [(f, _short(f, differ)) for f in differ]
    return ["" if one is None else " ".join(f"{name}={one.get(f)}" for f, name in short) for one in known]


def _short(field: str, others: Sequence[str]) -> str:
    """The last part of a dotted name, if that is clear enough."""
    last = field.rpartition(".")[2]
    return last if sum(other.rpartition(".")[2] == last for other in others) == 1 else field.partition(".")[2]


def _varying(names: Mapping[str, list[str]], otherwise: Sequence[str]) -> list[list[str]]:
    """The columns of names that differ between runs, or those in `otherwise` if none does."""
    varying = [column for column in names.values() if len(set(column)) > 1]
    return varying or [names[family] for family in otherwise]


def _size(value: Any, one: Settings | None, column: str) -> Any:
    """A number of the table, or what the scenario says: an MPCC that is no flight has no grid, but may have a size of that name."""
    told = (one or {}).get(f"scenario.{column}") if pd.isna(value) else value
    return told if isinstance(told, Real) else None


def _number(label: str, value: Any) -> str:
    return "" if pd.isna(value) else f"{label}={int(value)}"


def _join(columns: Sequence[Sequence[str]], separator: str = " / ") -> list[str]:
    return [separator.join(filter(None, parts)) for parts in zip(*columns, strict=True)]
