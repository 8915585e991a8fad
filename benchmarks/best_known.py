"""Fill the best known values: scenarios x kappa_init x dynamics x N, for each strategy.

    OMP_NUM_THREADS=1 python benchmarks/best_known.py
    OMP_NUM_THREADS=1 python benchmarks/best_known.py --grids verlet:100 collocation:25 --with workers=1 strategy=phases
    OMP_NUM_THREADS=1 python benchmarks/best_known.py --grids rk4:100 --kappa-init 2 --with strategy=enumeration
    OMP_NUM_THREADS=1 python benchmarks/best_known.py --grids lie_verlet:100 --with vehicle=table1_quaternion
    benchbench best results/best_known_runs

Ordinary isolated sweeps, one per grid, resumed where they were interrupted (docs/sweeps.md): a clean checkout, since a run
counts only for the commit that made it. What is found is kept in best_known.yaml of the output folder after each grid; the
last command merges it into references/best_known.yaml. `strategy=phases` takes the margins that the replay asks for, so that
no limit is kept more strictly than the certificate needs.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

SCENARIOS, KAPPA_INIT = ("static", "linear", "circle"), (2, 3, 5, 13, 23)
GRIDS = (
    ("verlet", 100), ("verlet", 150), ("verlet", 200), ("rk4", 50), ("collocation", 24), ("collocation", 25),
    ("collocation", 50),
)  # fmt: skip
"""Dynamics and N that are run unless others are asked for."""
PROGRAM = (sys.executable, "-m", "benchbench")


def grid_of(text: str) -> tuple[str, int]:
    """Dynamics and N; raises ArgumentTypeError."""
    dynamics, _, intervals = text.partition(":")
    if not intervals.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' was given, allowed: DYNAMICS:N, such as verlet:100")
    return dynamics, int(intervals)


def fill(root: Path, grid: tuple[str, int], kappa_init: Sequence[int], overrides: Sequence[str]) -> None:
    """Run one grid and keep what is best."""
    dynamics, intervals = grid
    product = [f"+scenario={','.join(SCENARIOS)}", f"scenario.kappa_init={','.join(map(str, kappa_init))}"]
    fixed = [f"dynamics={dynamics}", f"scenario.intervals={intervals}", f"output={root}"]
    print(f"\n{dynamics}:{intervals}", flush=True)
    subprocess.run([*PROGRAM, "-m", *product, *fixed, *overrides], check=False)
    subprocess.run([*PROGRAM, "best", str(root), "--file", str(root / "best_known.yaml")], check=False)


def main() -> None:
    """Fill grid after grid."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--output", type=Path, default=Path("results/best_known_runs"))
    parser.add_argument("--grids", nargs="+", type=grid_of, default=GRIDS, metavar="DYNAMICS:N")
    parser.add_argument("--kappa-init", nargs="+", type=int, default=KAPPA_INIT, metavar="NODES")
    parser.add_argument(
        "--with", nargs="+", default=["strategy=phases"], dest="overrides", metavar="OVERRIDE"
    )
    asked = parser.parse_args()
    asked.output.mkdir(parents=True, exist_ok=True)
    for grid in asked.grids:
        fill(asked.output, grid, asked.kappa_init, asked.overrides)


if __name__ == "__main__":
    main()
