"""A backend that ends its trial in the way it is asked for."""

from __future__ import annotations

import os
import signal
import time


def fault(question: str) -> str:
    match question:
        case "works":
            print("a banner, as libraries have")
        case "segfault":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "leaves":
            os._exit(0)
        case "hangs":
            time.sleep(600.0)
        case "raises":
            raise ImportError("libmissing.so: no such file")
    return "" if question == "works" else f"refuses: {question}"
