"""Command-line arguments of the commands beside planning; what is wrong with them is bad input like any other."""

from __future__ import annotations

from argparse import ArgumentParser, RawDescriptionHelpFormatter
from typing import NoReturn

from benchbench.errors import BadInput


class Parser(ArgumentParser):
    """An argument parser that raises BadInput; abbreviated options are refused."""

    def __init__(self, command: str, description: str, epilog: str = "") -> None:
        super().__init__(
            prog=f"benchbench {command}", description=description, epilog=epilog, allow_abbrev=False,
            formatter_class=RawDescriptionHelpFormatter,
        )  # fmt: skip

    def error(self, message: str) -> NoReturn:
        """Raise BadInput with the parser's message and the usage."""
        raise BadInput(self.prog, message, " ".join(self.format_usage().removeprefix("usage: ").split()))
