"""Whether the machine stayed the same: the CPU time of the fixed reference solve beside each timed run."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from benchbench.report.html.charts.chart import SYMBOLS, Chart, figure
from benchbench.report.html.room import drawn
from benchbench.report.style import CURVES


def charts(runs: pd.DataFrame) -> Iterator[Chart]:
    """Draw the reference solve over the time when a run began, a colour for each machine; nothing where it was not measured."""
    known = runs[runs.reference_cpu_s.notna() & runs.started_at.notna()]
    if known.empty:
        return
    known, said = drawn(known)
    spread = known.groupby(known.cpu.fillna("unknown")).reference_cpu_s.agg(["min", "max"])
    widest = 100 * float((spread["max"] / spread["min"] - 1).max())
    text = (
        "CPU time of one and the same solve beside each run with repeats. Where it drifts, the machine was loaded or its clock changed, and "
        f"CPU times of different moments compare as badly: here by up to {widest:.0f} % on one machine."
    )
    groups = list(known.groupby(known.cpu.fillna("unknown"), sort=False))
    made = figure("start of the run (UTC)", "reference solve [s]", names=[str(name) for name, _ in groups])
    for i, (name, some) in enumerate(groups):
        made.add_scatter(
            x=pd.to_datetime(some.started_at, utc=True, format="ISO8601"), y=some.reference_cpu_s.astype(float), mode="markers", name=str(name),
            marker={"color": CURVES[i % len(CURVES)], "symbol": SYMBOLS[i % len(SYMBOLS)], "size": 8}, text=some.run_id,
            hovertemplate="%{text}: %{y:.3f} s",
        )  # fmt: skip
    made.update_yaxes(rangemode="tozero")
    made.update_layout(showlegend=True)
    yield Chart("Drift of the machine", text + said, made)
