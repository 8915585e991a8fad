"""CPU time against an earlier commit: `python benchmarks/ratios.py PYTHON_OF_THE_OTHER [runs] [part ...]`.

PYTHON_OF_THE_OTHER is the interpreter of an environment in which that commit is installed. Both programs run in turn, in fresh
processes and fresh folders, A B A B, after one run of each that fills the cache of compiled blocks; printed are the medians of
their CPU seconds, children included, and of the ratios pair by pair. On a shared machine read the ratios.

Parts: command, help, version, refusal, number, plugins, again (the list of plugins), sweep (a run among others: eight runs less
two, over six); certificate, coarse and gates, which time the certificate alone and need a commit that has it where it is today.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable

CIRCLE = ("+scenario=circle", "solver=ipopt")
SWEEP = ("-m", *CIRCLE, "scenario.intervals=25", "workers=1")
CERTIFY = """
import json, sys, time
try:
    from benchbench.run import pipeline
except ImportError:  # where it was earlier
    from benchbench import pipeline
from benchbench.certificate.certify import certify
from benchbench.run import config
case = config.compose(*sys.argv[1:])
plan = pipeline.run(case).result.plan
taken = []
for _ in range(6):
    began = time.process_time()
    certify(plan, case.scenario, case.model, case.limits)
    taken.append(time.process_time() - began)
print(json.dumps(sorted(taken[1:])[2]))
"""
Measure = Callable[[str], float]


def main(other: str, runs: int, wanted: list[str]) -> None:
    """Print the table."""
    parts: dict[str, tuple[str, Measure]] = {
        "command": ("default command, circle", lambda python: _cpu(python, *CIRCLE)),
        "help": ("--help", lambda python: _cpu(python, "--help")),
        "version": ("--version", lambda python: _cpu(python, "--version")),
        "refusal": ("a solver that does not exist", lambda python: _cpu(python, *CIRCLE[:1], "solver=nope")),
        "number": (
            "a number that a scenario refuses",
            lambda python: _cpu(python, *CIRCLE, "scenario.contact_guess=2"),
        ),
        "plugins": ("plugins, nothing remembered", _first_list),
        "again": ("plugins, nothing changed", lambda python: _cpu(python, "plugins")),
        "sweep": ("a run in a sweep, circle, N = 25", _in_a_sweep),
        "certificate": ("certificate, circle, N = 100", lambda python: _certificate(python, *CIRCLE)),
        "coarse": (
            "certificate, circle, N = 25",
            lambda python: _certificate(python, *CIRCLE, "scenario.intervals=25"),
        ),
        "gates": (
            "certificate, 19 gates",
            lambda python: _certificate(python, "+scenario=race", "scenario.gates=19"),
        ),
    }
    print("| what | then s | now s | ratio, median (min to max) |\n|---|---|---|---|")
    for name in wanted or parts:
        what, measure = parts[name]
        pairs = [(measure(other), measure(sys.executable)) for _ in range(runs + 1)][1:]
        ratios = [now / then for then, now in pairs]
        then, now = (statistics.median(column) for column in zip(*pairs, strict=True))
        spread = f"{min(ratios):.3f} to {max(ratios):.3f}"
        print(f"| {what} | {then:.3f} | {now:.3f} | {statistics.median(ratios):.3f} ({spread}) |", flush=True)


def _cpu(python: str, *arguments: str, **variables: str) -> float:
    """CPU seconds of one call of the program, children included."""
    before = _children()
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run(
            [python, "-m", "benchbench", *arguments],
            cwd=scratch,
            env=_environment() | variables,
            capture_output=True,
            check=False,
        )
    return _children() - before


def _first_list(python: str) -> float:
    with tempfile.TemporaryDirectory() as empty:
        return _cpu(python, "plugins", BENCHBENCH_CACHE=empty)


def _in_a_sweep(python: str) -> float:
    few, many = (_cpu(python, *SWEEP, f"seed=range(0,{count})") for count in (2, 8))
    return (many - few) / 6


def _certificate(python: str, *overrides: str) -> float:
    with tempfile.TemporaryDirectory() as scratch:
        done = subprocess.run(
            [python, "-c", CERTIFY, *overrides],
            cwd=scratch,
            env=_environment(),
            capture_output=True,
            text=True,
            check=True,
        )
    return float(json.loads(done.stdout.splitlines()[-1]))


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _environment() -> dict[str, str]:
    return {**os.environ, "OMP_NUM_THREADS": "1"}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("other", help="interpreter of an environment with the other commit")
    parser.add_argument("runs", nargs="?", type=int, default=5, help="pairs of each part")
    parser.add_argument("part", nargs="*", help="all of them where none is named")
    asked = parser.parse_args()
    main(asked.other, asked.runs, asked.part)
