"""Everything that can go wrong, in the user's words.

A `BadInput` ends the program with exit code 2 and one message that names the field and what is
allowed; in a sweep its text becomes the row's reason.
"""

from __future__ import annotations

from collections.abc import Sequence


class BenchBenchError(Exception):
    """Root of all errors that BenchBench raises on purpose."""


class BadInput(BenchBenchError):
    """The configuration or a file asks for something impossible; the message says what is allowed."""

    def __init__(self, field: str, problem: str, allowed: str = "") -> None:
        self.field, self.problem, self.allowed = field, problem, allowed
        super().__init__(f"{field}: {problem}" + (f"; allowed: {allowed}" if allowed else ""))


class IncompatibleCase(BadInput):
    """Two choices that are fine alone cannot work together."""


class Unavailable(BenchBenchError):
    """An optional backend is not installed or has no licence; the message names the remedy."""


def unknown_choice(field: str, value: str, available: Sequence[str]) -> BadInput:
    """Return the error for a misspelt plugin or scenario name, listing what exists."""
    return BadInput(field, f"'{value}' does not exist", ", ".join(sorted(available)))
