"""Strategies that end a run in every bad way; the launcher's tests choose them by `_target_`."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass

import numpy as np

from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.result import Result
from benchbench_plugins.strategies.phases import Phases


@dataclass(frozen=True)
class Bad(Strategy):
    """Ends as `how` says; `fine` plans."""

    how: str

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Misbehave."""
        match self.how:
            case "segfault":
                os.kill(os.getpid(), signal.SIGSEGV)
            case "exit":
                os._exit(7)
            case "spin":
                signal.signal(signal.SIGTERM, signal.SIG_IGN)
                signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals) - {signal.SIGKILL})
                while True:
                    time.sleep(1.0)
            case "native":
                pow(3, 10**9)  # one instruction that holds the interpreter for hours
            case "memory":
                hoard = []
                while (
                    True
                ):  # not written to: some machines need 5 s for each GB, and the limit counts it anyway
                    hoard.append(np.empty(10**7))
            case "raise":
                raise RuntimeError("first line\nout of cheese")
        return Phases(margin=0.0).solve(case, ledger)
