"""How far the default's plan is from the best of many starts of the same task: `python benchmarks/starts.py 1 20 8`.

Seeds of `random_handover` from the first number to the second, and so many starts of each (scenario.family.seed is the task, seed the
disturbance of the start; one start per run, 20 s of wall clock each). Prints travel times of certified plans and the gap of the first.
"""

from __future__ import annotations

import sys

from benchbench.run import config, pipeline


def times(task: int, starts: int) -> list[float | None]:
    """Travel time in s from each start, None without a certified plan."""
    found = []
    for seed in range(starts):
        told = (f"scenario.family.seed={task}", f"seed={seed}", "strategy.starts=1", "time_limit=20")
        record = pipeline.run(config.compose("+scenario=random_handover", *told)).record
        found.append(float(record["travel_time_s"]) if record["certified"] else None)
    return found


def main() -> None:
    """Print one line per task."""
    first, last, starts = (int(text) for text in sys.argv[1:4])
    for task in range(first, last + 1):
        own, *others = times(task, starts)
        best = min((t for t in (own, *others) if t is not None), default=None)
        gap = f"{100 * (own / best - 1):.2f} %" if own is not None and best is not None else "-"
        shown = " ".join("-" if t is None else f"{t:.4f}" for t in (own, *others))
        print(f"{task:3d}  gap {gap:>7}  {shown}", flush=True)


if __name__ == "__main__":
    main()
