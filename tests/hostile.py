"""A strategy that does, in one of many ways, what a plugin should not do to its process, its neighbours or its parent.

What leaves the process alive is followed by a plan (`after="plan"`) or by an error (`after="raise"`, which is cheaper).
"""

from __future__ import annotations

import _thread
import atexit
import builtins
import ctypes
import gc
import itertools
import locale
import math
import os
import pickle
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import casadi
import numpy as np
from hydra.core.hydra_config import HydraConfig

from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.result import Result
from benchbench.run import execution, pipeline
from benchbench_plugins.strategies.phases import Phases

WAYS: dict[str, Callable[[], Any]] = {}
Way = Callable[[], Any]


@dataclass(frozen=True)
class Hostile(Strategy):
    """Misbehaves in the way of that name; any name that begins with "fine" only plans."""

    way: str
    after: Literal["plan", "raise"] = "plan"

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Misbehave, then plan."""
        if not self.way.startswith("fine"):
            WAYS[self.way]()
            if self.after == "raise":
                raise RuntimeError("spoiled")
        return Phases(margin=0.0).solve(case, ledger)


def way(function: Way) -> Way:
    """Add a way under the name of its function."""
    WAYS[function.__name__] = function
    return function


def folder() -> Path:
    """The run's own."""
    return Path(HydraConfig.get().runtime.output_dir)


class Abort(BaseException):
    """What no `except Exception` catches."""


# ends of the process


@way
def system_exit() -> None:
    sys.exit(0)


@way
def base_exception() -> None:
    raise Abort("not an Exception")


@way
def keyboard_interrupt() -> None:
    raise KeyboardInterrupt


@way
def generator_exit() -> None:
    raise GeneratorExit


@way
def exit_0() -> None:
    os._exit(0)


@way
def exit_from_a_thread() -> None:
    threading.Timer(0.05, os._exit, (3,)).start()
    time.sleep(60.0)


@way
def abort() -> None:
    os.abort()


@way
def segfault() -> None:
    ctypes.string_at(0)


@way
def native_stack_overflow() -> None:
    sys.setrecursionlimit(10**9)
    deep: Any = None
    for _ in range(10**6):
        deep = [deep]
    repr(deep)


@way
def kill_itself() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


@way
def terminate_its_group() -> None:
    os.killpg(0, signal.SIGTERM)


@way
def interrupt_itself() -> None:
    _thread.interrupt_main()
    time.sleep(0.2)


@way
def alarm() -> None:
    signal.setitimer(signal.ITIMER_REAL, 0.05)
    time.sleep(60.0)


@way
def replace_itself() -> None:
    os.execv("/bin/true", ["true"])


# limits, which need `hard_limit`


@way
def spin_deaf() -> None:
    for number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals))
    while True:
        time.sleep(1.0)


@way
def native_loop() -> None:
    pow(3, 10**9)


@way
def stop_itself() -> None:
    os.kill(os.getpid(), signal.SIGSTOP)


@way
def stop_its_keeper() -> None:
    os.kill(os.getppid(), signal.SIGSTOP)
    time.sleep(600.0)


@way
def dead_lock() -> None:
    lock = threading.Lock()
    lock.acquire(), lock.acquire()


# attacks on the keeper


@way
def kill_its_keeper() -> None:
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(60.0)


@way
def kill_its_keeper_and_live_on() -> None:
    ctypes.CDLL(None).prctl(1, 0)  # no signal at its death
    if os.fork() == 0:
        os.setsid()
        time.sleep(600.0)
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(600.0)


@way
def write_to_every_descriptor() -> None:
    for number in range(256):
        try:
            os.write(number, b"\x80\x04garbage")
        except OSError:
            continue


@way
def close_every_descriptor() -> None:
    os.closerange(0, 256)


@way
def answer_in_its_own_words() -> None:
    forged = pickle.dumps((os.system, ("touch /tmp/forged",)))
    for entry in os.listdir("/proc/self/fd"):
        if Path(f"/proc/self/fd/{entry}").resolve().name.startswith("memfd"):
            os.write(int(entry), forged)
    os._exit(0)


# what a warm worker would keep


@way
def patch_numpy() -> None:
    for name in ("sum", "asarray", "zeros", "linspace", "concatenate", "full", "arange", "clip"):
        setattr(np, name, lambda *_, **__: 0.0)
    np.linalg.norm = lambda *_, **__: 0.0  # type: ignore[assignment]
    np.seterr(all="raise")


@way
def patch_casadi() -> None:
    casadi.SX.sym = casadi.MX.sym = casadi.vertcat = None
    casadi.nlpsol = lambda *_, **__: None


@way
def patch_math_and_builtins() -> None:
    math.pi, math.isfinite = 3.0, lambda _: True
    for name in ("sum", "len", "open", "print", "min", "isinstance"):
        setattr(builtins, name, lambda *_, **__: 0)


@way
def patch_us() -> None:
    pipeline.run = pipeline.write = None  # type: ignore[assignment]
    execution.failure = execution.execute = lambda *_, **__: None  # type: ignore[assignment]


@way
def patch_the_exits() -> None:
    os._exit = sys.exit = os.abort = lambda *_: None  # type: ignore[assignment]
    sys.excepthook = lambda *_: 1 / 0


@way
def forget_the_modules() -> None:
    sys.modules.clear()
    sys.path.clear()


@way
def close_the_outputs() -> None:
    sys.stdout.close(), sys.stderr.close()
    os.close(1), os.close(2)


@way
def replace_the_outputs() -> None:
    class Stuck:
        def write(self, _: str) -> None:
            time.sleep(600.0)

        flush: Any = property(lambda _: 1 / 0)

    sys.stdout = sys.stderr = sys.__stdout__ = Stuck()  # type: ignore[assignment]
    sys.stdout = None  # type: ignore[assignment]


@way
def change_the_folder() -> None:
    os.chdir("/")


@way
def lose_the_folder() -> None:
    os.chdir(tempfile.mkdtemp())
    os.rmdir(os.getcwd())


@way
def set_limits() -> None:
    resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    resource.setrlimit(resource.RLIMIT_STACK, (2**16, 2**16))
    resource.setrlimit(resource.RLIMIT_AS, (2**28, 2**28))


@way
def limit_its_cpu_time() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (1, 1))
    while True:
        math.sqrt(2.0)


@way
def set_the_environment() -> None:
    os.environ.clear()
    os.environ.update(
        OMP_NUM_THREADS="64",
        PATH="",
        LC_ALL="C",
        TZ="Asia/Kolkata",
        HOME="/proc/nowhere",
        TMPDIR="/proc/nowhere",
    )
    os.umask(0o777)
    time.tzset()
    locale.setlocale(locale.LC_ALL, "C")
    os.nice(10)
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


@way
def set_the_interpreter() -> None:
    sys.setrecursionlimit(len(__import__("inspect").stack()) + 60)
    gc.disable()
    warnings.simplefilter("error")
    random.seed(0), np.random.seed(0)
    sys.setswitchinterval(100.0)
    sys.setprofile(lambda *_: None)


@way
def ignore_signals() -> None:
    for number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}:
        signal.signal(number, signal.SIG_IGN)


@way
def drop_rights() -> None:
    if os.geteuid() == 0:
        os.setgroups([])
        os.setresgid(65534, 65534, 65534)
        os.setresuid(65534, 65534, 65534)


# what stays behind


@way
def leave_threads() -> None:
    for _ in range(4):
        threading.Thread(target=time.sleep, args=(600.0,), daemon=False).start()
    atexit.register(time.sleep, 600.0)


@way
def leave_children() -> None:
    for _ in range(3):
        subprocess.Popen(["sleep", "600"], start_new_session=True)


@way
def leave_a_daemon() -> None:
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals))
            time.sleep(600.0)
        os._exit(0)
    os.wait()


@way
def leave_a_brood() -> None:
    for _ in range(6):
        os.fork()
    if os.getpid() != os.getpgrp():
        time.sleep(600.0)


@way
def return_twice() -> None:
    os.fork()


# too much


@way
def print_much() -> None:
    line = b"x" * 2**20
    for _ in range(100):
        os.write(1, line)


@way
def say_much() -> None:
    raise RuntimeError("y" * 50_000_000)


@way
def say_nothing_printable() -> None:
    raise type("\x1b[2J", (RuntimeError,), {})("\x1b[31m\ud800\x00 ‮ =cmd()")


@way
def not_even_say() -> None:
    raise type("Mute", (RuntimeError,), {"__str__": lambda _: 1 / 0, "__repr__": lambda _: 1 / 0})()


@way
def take_memory() -> None:
    hoard = [np.empty(10**7) for _ in itertools.count()]  # not written to: the limit counts it anyway
    del hoard


@way
def recurse() -> None:
    recurse()


# its own files


@way
def remove_its_files() -> None:
    shutil.rmtree(folder())


@way
def forge_its_record() -> None:
    (folder() / "record.json").write_text("{}")
    os._exit(0)


@way
def be_in_the_way() -> None:
    shutil.rmtree(folder())
    folder().write_text("a file where the folder was")
