"""The examples of docs/your_problem.md do what the page says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from program import told

import benchbench as bb

EXAMPLES = Path(__file__).parents[1] / "examples"


def own(monkeypatch: pytest.MonkeyPatch, example: str) -> str:
    """Make the folder of an example one that Python and Hydra look into."""
    monkeypatch.syspath_prepend(str(EXAMPLES / example))
    return f"hydra.searchpath=[file://{EXAMPLES / example / 'conf'}]"


def test_a_sphere_is_flown_around(monkeypatch: pytest.MonkeyPatch) -> None:
    """By its replay, not by our own condition; without the sphere it would be flown through."""
    sphere = own(monkeypatch, "obstacle")
    run, without = bb.plan(sphere, "+scenario=around"), bb.plan("+scenario=static")
    _, _, replay = run.source.scene()
    assert run.certified and without.certified and replay is not None and without.plan is not None
    centre, radius = (1.8, 0.02, 0.62), 0.35
    away, through = (
        float(np.linalg.norm(flown.configuration[:, :3] - centre, axis=1).min())
        for flown in (replay, without.plan)
    )
    assert away > radius - 0.01 and through < 0.5 * radius
    assert run.travel_time is not None and without.travel_time is not None
    assert run.travel_time > without.travel_time


def test_a_sphere_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchbench.report.views import marks
    from benchbench.run import config

    case = config.compose(own(monkeypatch, "obstacle"), "+scenario=around")
    found = marks(case.scenario, None)  # type: ignore[arg-type]  # a handover's do not depend on the plan
    (line,) = found.outlines.values()
    distance = np.linalg.norm(line - (1.8, 0.02, 0.62), axis=1)
    assert found.name == "obstacles" and distance[~np.isnan(distance)] == pytest.approx(0.35)


def test_the_block_obeys_friction_and_wall(tmp_path: Path) -> None:
    """Its push is applied step by step to a block that knows nothing of complementarity."""
    folder = EXAMPLES / "block_and_wall"
    done = told(tmp_path, "--config-dir", str(folder / "conf"), "+scenario=block_and_wall", "relaxation=scholtes",
                "hydra.run.dir=out", PYTHONPATH=str(folder))  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    w = np.ravel(json.loads((tmp_path / "out" / "solution.json").read_text())["w"])
    x, v, u, wall = w.reshape(7, 20)[:4]
    h, place, speed = 0.1, 0.0, 0.0
    for k in range(20):
        free = speed + h * u[k]
        slowed = np.sign(free) * max(abs(free) - h * 2.0, 0.0)
        speed = min(slowed, (1.0 - place) / h)
        place += h * speed
        assert (place, speed) == (pytest.approx(x[k], abs=1e-5), pytest.approx(v[k], abs=1e-5))
    assert place == pytest.approx(1.0, abs=1e-6) and wall[-1] >= 3.0 - 1e-6
    # In the last step, at rest, friction may point either way: least effort takes all of it to press the wall.
    assert wall[-1] - (v[-2] / h + u[-1]) == pytest.approx(2.0, abs=1e-4)
