"""Interchangeable means interchangeable: every scenario with every dynamics and strategy, everything else default.

    OMP_NUM_THREADS=1 python benchmarks/matrix.py [--output results/matrix]

Prints a table: the certified travel time with the CPU seconds of build, solve and check in all rounds, or why not. Resumed where
it was interrupted, as all sweeps are.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import benchbench as bb

SCENARIOS = {"static": "", "linear": "", "circle": "", "delivery": "", "race": "scenario.gates=4"}
DYNAMICS = ("verlet", "midpoint", "lie_verlet", "trapezoidal", "hermite_simpson", "rk4", "collocation")
STRATEGIES = {"auto": "", "enumeration": "", "relax": "relaxation=scholtes"}
PROGRAM = (sys.executable, "-m", "benchbench")


def sweep(root: Path, seconds: int) -> None:
    """Run what is missing, one sweep per scenario and strategy."""
    for scenario, gates in SCENARIOS.items():
        for strategy, relaxation in STRATEGIES.items():
            asked = [f"+scenario={scenario}", *gates.split(), f"strategy={strategy}", *relaxation.split()]
            asked += [
                f"dynamics={','.join(DYNAMICS)}",
                f"time_limit={seconds}",
                f"output={root}",
                "picture=false",
                "workers=1",
            ]
            subprocess.run([*PROGRAM, "-m", *asked], check=False)


def lines(root: Path) -> Iterator[str]:
    """The table, one row per scenario and dynamics, one column per strategy."""
    runs = bb.runs(str(root))
    yield f"| scenario | dynamics | {' | '.join(STRATEGIES)} |"
    yield f"|---|---|{'---|' * len(STRATEGIES)}"
    for scenario in SCENARIOS:
        for dynamics in DYNAMICS:
            own = runs[(runs.scenario == scenario) & (runs.dynamics == dynamics)]
            cells = [cell(own[own.strategy == strategy]) for strategy in STRATEGIES]
            yield f"| {scenario} | {dynamics} | {' | '.join(cells)} |"


def cell(found: object) -> str:
    """What came of one combination: the last run of it."""
    if not len(found):  # type: ignore[arg-type]
        return "-"
    run = found.iloc[-1]  # type: ignore[attr-defined]
    seconds = sum(
        float(run[k] or 0.0) for k in ("build_cpu_s", "solve_cpu_s", "certificate_cpu_s") if run[k] == run[k]
    )
    if run.certified:
        return f"{run.travel_time_s:.3f} s, {seconds:.1f} s CPU"
    if run.status in ("incompatible", "bad_input"):
        return "refused"
    why = run.reasons[0] if len(run.reasons) else run.detail
    return f"{run.status}, {seconds:.1f} s CPU: {str(why)[:70]}"


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--output", type=Path, default=Path("results/matrix"))
    parser.add_argument("--seconds", type=int, default=20, help="time_limit of each run, CPU seconds")
    chosen = parser.parse_args()
    sweep(chosen.output, chosen.seconds)
    print("\n".join(lines(chosen.output)))


if __name__ == "__main__":
    main()
