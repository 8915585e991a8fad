"""Everything that can go wrong, in the user's words.

A `BadInput` ends the program with exit code 2 and one message that names the field and what is
allowed; in a sweep its text becomes the row's reason.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import ValidationError


LIMITS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
"""What pydantic calls numbers beyond a limit."""


class BenchBenchError(Exception):
    """Root of all errors that BenchBench raises on purpose."""


class BadInput(BenchBenchError):
    """The configuration or a file asks for something impossible; the message says what is allowed."""

    def __init__(self, field: str, problem: str, allowed: str = "") -> None:
        self.field, self.problem, self.allowed = field, problem, allowed
        super().__init__(f"{field}: {problem}" + (f"; allowed: {allowed}" if allowed else ""))

    def __reduce__(self) -> tuple[type[BadInput], tuple[str, str, str]]:
        """Pickle the parts, of which the text is made again, for one that is raised in a child process."""
        return type(self), (self.field, self.problem, self.allowed)


class IncompatibleCase(BadInput):
    """Two choices that are fine alone cannot work together."""


class Unavailable(BenchBenchError):
    """An optional backend is not installed or has no licence; the message names the remedy."""


class Pruned(BenchBenchError):
    """A study gave a run up, since its trial cannot become the best any more."""


class Timeout(BenchBenchError):
    """A run was killed at its wall-clock limit."""


class Crash(BenchBenchError):
    """The process of a run died; the message names the signal or exit code."""


class OutOfMemory(BenchBenchError):
    """The process of a run died of its memory limit."""


class NoPlan(BenchBenchError):
    """An external planner ended without a plan that can be read."""


def unknown_choice(field: str, value: str, available: Iterable[str]) -> BadInput:
    """Return the error for a misspelt plugin or scenario name, listing what exists."""
    return BadInput(field, f"'{value}' does not exist", ", ".join(sorted(available)))


def unknown_field(field: str, names: Iterable[str], add: str = "") -> BadInput:
    """Return the error for a field that does not exist where `names` do; it suggests the nearest.

    add: how to make a new field of that name, where that is possible.
    """
    names = list(names)
    if near := get_close_matches(field.rpartition(".")[2], names, 1):
        return BadInput(field, f"does not exist, perhaps '{near[0]}' is meant", ", ".join(names))
    return BadInput(field, "does not exist", "; or ".join(part for part in (", ".join(names), add) if part))


def invalid(field: str, error: ValidationError, names: Iterable[str] = ()) -> BadInput:
    """Return a pydantic error about `field` in our words; `names` are the fields that exist there."""
    first = error.errors()[0]
    place = ".".join([field, *(str(part) for part in first["loc"])])
    given, text = first["input"], first["msg"].removeprefix("Value error, ")
    match first["type"]:
        case "too_long":
            return BadInput(place, f"{given!r} is too long", f"at most {first['ctx']['max_length']} values")
        case "tuple_type" | "list_type":
            return BadInput(place, f"{given!r} was given", "a list, as [0, 1]")
        case "missing" | "missing_argument":
            return BadInput(place, "is missing")
        case "extra_forbidden" | "unexpected_keyword_argument":
            return unknown_field(place, names)
        case "is_instance_of":
            wanted = f"{{_target_: package.module.Class, ...}} that makes a {first['ctx']['class']}"
            return BadInput(place, f"{given!r} was given", wanted)
        case _ if text.startswith("Input should be "):
            wanted = text.removeprefix("Input should be ").partition(", unable")[0].partition(", got")[0]
            return BadInput(
                place,
                f"{given!r} was given",
                ("a number " if first["type"] in LIMITS else "") + wanted,
            )
    return BadInput(place, f"{text}, but {given!r} was given")
