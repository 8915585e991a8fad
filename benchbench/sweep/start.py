"""The first moment of a keeper: before its imports, which take a second, it is told when to die."""

from __future__ import annotations

import os
import pickle
import signal
from multiprocessing.connection import Connection

from benchbench.sweep import processes


def start(channel: Connection, about: bytes) -> None:
    """Become a keeper that hears requests over `channel`; `about` are its other arguments, pickled."""
    os.setsid()  # Ctrl-C is for the parent
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    processes.die_with_parent()  # while it imports it cannot hear that its parent is gone
    from benchbench.sweep.keeper import keep

    keep(channel, *pickle.loads(about))
