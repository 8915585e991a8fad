"""Functions that ask a question of the certificate, by name: an entry point, or package.module.function."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

from benchbench.ground.errors import BadInput

GROUP = "benchbench.checks"
"""Entry point group in which installed packages give their checks short names."""


@cache
def named(name: str) -> Callable[..., Any]:
    """Return the function; raises BadInput where there is none."""
    try:
        found = _dotted(name) if "." in name else _registered(name)
    except Exception as error:  # noqa: BLE001  # importing somebody's module can raise anything
        raise BadInput(
            _field(name), f"cannot be loaded: {type(error).__name__}: {error}", _allowed()
        ) from None
    if not callable(found):
        raise BadInput(
            _field(name), "there is no such check" if found is None else "is no function", _allowed()
        )
    return found


def fitting(name: str, limit: float | bool) -> None:
    """Raise BadInput where there is no such function, or where it does not take the limit, or needs one."""
    arguments = () if limit is True else (limit,)
    try:
        inspect.signature(named(name)).bind(None, *arguments)
    except TypeError:
        problem, allowed = ("takes no limit", "true") if arguments else ("needs a limit", "a number")
        raise BadInput(_field(name), problem, f"{allowed}, or null to leave it out") from None


def _dotted(name: str) -> Any:
    module, _, function = name.rpartition(".")
    return getattr(import_module(module), function, None)


def _registered(name: str) -> Any:
    return next((entry.load() for entry in entry_points(group=GROUP, name=name)), None)


def _field(name: str) -> str:
    return f"certificate.checks.{name}"


def _allowed() -> str:
    """What a name may be."""
    return ", ".join([*sorted(entry_points(group=GROUP).names), "package.module.function"])
