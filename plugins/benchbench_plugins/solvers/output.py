"""Keeps what CasADi and its libraries print off the terminal."""

from __future__ import annotations

import contextlib
import ctypes
import io
import logging
import os
import re
import sys
from collections.abc import Iterator

log = logging.getLogger(__name__)


@contextlib.contextmanager
def quiet(errors: bool = True) -> Iterator[io.StringIO]:
    """Send what CasADi prints (and with `errors` its warnings) to the debug log; drop what libraries print."""
    text = io.StringIO()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_descriptor_closed(1))
        stack.enter_context(contextlib.redirect_stdout(text))
        if errors:
            stack.enter_context(contextlib.redirect_stderr(text))
        yield text
    if text.getvalue():
        log.debug(text.getvalue())


@contextlib.contextmanager
def _descriptor_closed(number: int) -> Iterator[None]:
    """Point a file descriptor at nothing: Uno prints a line for each fixed unknown, whatever its options say."""
    if os.name != "posix":
        yield
        return
    sys.stdout.flush()
    flush = ctypes.CDLL(None).fflush
    kept, nowhere = os.dup(number), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    try:
        yield
    finally:
        flush(None)
        os.dup2(kept, number)
        os.close(kept)
        os.close(nowhere)


def last_line(error: RuntimeError) -> str:
    """What CasADi says in the end, without the place in its source."""
    return re.sub(r"^\.\.\./\S+: ", "", str(error).strip().splitlines()[-1].strip()).removeprefix(
        "Error code: "
    )
