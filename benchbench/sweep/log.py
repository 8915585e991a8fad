"""What a run prints, in a file that does not grow without bound."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from types import TracebackType
from typing import IO, Self, final

KEPT = 1_000_000
"""Bytes of the beginning of a run's output that are kept."""
TAIL = 20_000
"""Bytes of its end that are kept: a native program says there what it died of."""


@final
class Log:
    """A context that makes the file; an empty one is removed, and a disk that refuses it costs the log only."""

    def __init__(self, path: Path) -> None:
        """Take the path of the file."""
        self._path, self._size, self._tail = path, 0, b""
        self._file: IO[bytes] | None = None

    def __enter__(self) -> Self:
        """Make the file and its folder."""
        with contextlib.suppress(OSError):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._file = self._path.open("wb", buffering=0)
        return self

    def take(self, output: int) -> int | None:
        """Move what can be read from a descriptor that does not block; returns the bytes, None at its end."""
        try:
            data = os.read(output, 1 << 16)
        except BlockingIOError:
            return 0
        self._write(data[: max(0, KEPT - self._size)])
        self._size += len(data)
        self._tail = (self._tail + data)[-TAIL:]
        return len(data) or None

    @property
    def tail(self) -> str:
        """The last of what was printed."""
        return self._tail.decode(errors="replace")

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Write the end of an output that was cut."""
        if self._size > KEPT:
            last = self._tail[-(self._size - KEPT) :]
            left_out = self._size - KEPT - len(last)
            self._write(b"\n[%d bytes are left out here]\n" % left_out + last)
        if self._file:
            self._file.close()
            with contextlib.suppress(OSError):
                if not self._size:
                    self._path.unlink()

    def _write(self, data: bytes) -> None:
        try:
            if self._file and data:
                self._file.write(data)
        except OSError:  # the disk is full
            self._file = None
