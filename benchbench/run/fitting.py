"""Lines for people: on a terminal wrapped at words, the rest of a line indented; in a pipe as they are. Imports next to nothing."""

from __future__ import annotations

import shutil
import sys
import textwrap


def on_terminal() -> bool:
    """Whether somebody looks at what is printed."""
    return sys.stdout.isatty()


def width() -> int:
    """Columns of the terminal; of a pipe, 80."""
    return shutil.get_terminal_size().columns


def fitted(line: str, indent: int) -> str:
    """Return a line as it is printed; what does not fit goes below it, `indent` columns to the right, at most to the middle."""
    if not on_terminal() or len(line) <= width():
        return line
    rest = " " * min(indent, width() // 2)
    return textwrap.fill(
        line, width(), subsequent_indent=rest, break_long_words=False, break_on_hyphens=False
    )
