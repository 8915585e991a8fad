"""Plans from elsewhere: the CSV format, and `benchbench certify` on good and spoiled plans of an independent simulator."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from benchbench import config, pipeline
from benchbench.storage.flight import flight_of
from benchbench.storage.flight_csv import to_csv

RACE = ("+scenario=race", "scenario.gates=1", "scenario.nodes_per_gate=20")
HANDOVER = ("+scenario=static", "strategy=phases", "scenario.intervals=30")


@cache
def own(*overrides: str) -> pipeline.Run:
    return pipeline.run(config.compose(*overrides))


@pytest.mark.parametrize("overrides", [RACE, HANDOVER])
def test_our_plan_comes_back_with_the_same_numbers(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    """Quaternions, or Euler angles with an arm: exported, read and judged again."""
    done = own(*overrides)
    file = tmp_path / "plan.csv"
    file.write_text(to_csv(flight_of(done.result.plan)))
    again = pipeline.run(config.compose(*overrides[:2], "strategy=foreign", f"strategy.file={file}"))
    for name in ("time", "configuration", "velocity", "inputs", "progress"):
        np.testing.assert_allclose(
            getattr(again.result.plan, name), getattr(done.result.plan, name), atol=1e-9
        )
    assert again.certificate.certified == done.certificate.certified
    for name, value in vars(done.certificate.measures).items():
        if isinstance(value, float) and name not in (
            "max_violation",
            "max_complementarity",
        ):  # of no problem of ours
            assert getattr(again.certificate.measures, name) == pytest.approx(value, rel=1e-4, abs=1e-7), name
    assert again.record["solver"] == again.record["strategy"] == "foreign"
