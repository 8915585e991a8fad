"""Command-line arguments of the commands beside planning; what is wrong with them is bad input like any other."""

from __future__ import annotations

import shutil
import textwrap
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from typing import NoReturn

from benchbench.ground.errors import BadInput


class Parser(ArgumentParser):
    """An argument parser that raises BadInput; abbreviated options are refused.

    overrides  whether what it does not know are overrides of the main command
    """

    def __init__(self, command: str, description: str, epilog: str = "", overrides: bool = False) -> None:
        super().__init__(
            prog=f"benchbench {command}", description=_folded(description), epilog=_folded(epilog), allow_abbrev=False,
            formatter_class=RawDescriptionHelpFormatter,
        )  # fmt: skip
        self.overrides = overrides

    def explain(self) -> str:
        """Return the help, with the overrides in its usage."""
        usage = " ".join(self.format_usage().removeprefix("usage: ").split())
        self.usage = usage + " [OVERRIDE ...]" if self.overrides else usage
        return self.format_help()

    def error(self, message: str) -> NoReturn:
        """Raise BadInput with the parser's message and the usage."""
        raise BadInput(self.prog, message, " ".join(self.format_usage().removeprefix("usage: ").split()))


def _folded(text: str) -> str:
    """Fold prose to the terminal, and leave what is set in lines as it is."""
    width = min(shutil.get_terminal_size().columns, 100)
    parts = text.split("\n\n")
    return "\n\n".join(part if "\n  " in part else textwrap.fill(part, width) for part in parts)
