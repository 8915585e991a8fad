"""Targets as data: paths of up to 10,000 rows cost what a circle costs, noise is taken out where it is declared."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from pydantic import ValidationError
from scipy.interpolate import CubicSpline
from small_mpccs import by_hand

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.mpcc.derivatives import derivatives
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.program import assemble
from benchbench.ocp.motion import motion_state, planned, sample
from benchbench.run import config, pipeline
from benchbench_plugins.motions import Combined, Linear, Spline

ROWS = 10_000
NOISE = 1e-3


def circle(time: Array) -> Array:
    """The target of scenario=circle, (n, 3) m."""
    return np.stack(
        [1.1 + 0.4 * np.sin(0.3 * time), 0.4 * np.cos(0.3 * time), np.full_like(time, 0.4)], axis=1
    )


def written(path: Path, time: Array, position: Array) -> Path:
    np.savetxt(path, np.column_stack([time, position]), delimiter=",", header="t,x,y,z", comments="")
    return path


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten minutes of the circle."""
    time = np.linspace(0.0, 600.0, ROWS)
    return written(tmp_path_factory.mktemp("path") / "circle.csv", time, circle(time))


def expression(motion: Spline) -> ca.Function:
    """Position and velocity as a block function of the time."""
    z, sigma = ca.SX.sym("z", 1), ca.SX.sym("sigma")
    position, velocity = motion_state(motion, z[0], ca.SX(0, 1))
    return ca.Function("at", [z, ca.SX.sym("p", 0), sigma], [ca.vertcat(position, velocity)])


def test_the_expression_does_not_grow_with_the_rows(tmp_path: Path, recorded: Path) -> None:
    few = np.linspace(0.0, 9.0, 10)
    small = Spline(written(tmp_path / "few.csv", few, circle(few)))
    counts = [expression(motion).n_instructions() for motion in (small, Spline(recorded))]
    assert counts[0] == counts[1] < 100
    assert len(Spline(recorded).parameters) == 0, "which every node of a grid would repeat"


@pytest.mark.slow
def test_ten_minutes_of_a_recording_are_planned_like_the_circle_they_show(recorded: Path) -> None:
    """The same flight in as many iterations: the interpolation is 2e-11 m off, so only rounding differs."""
    target = f"scenario.target={{_target_: benchbench_plugins.motions.Spline, csv: {recorded}}}"
    case = config.compose("+scenario=circle", "~scenario.target", f"+{target}", "solver=ipopt")
    by_data = pipeline.run(case).record
    by_formula = pipeline.run(config.compose("+scenario=circle", "solver=ipopt")).record
    assert by_data["certified"] and by_formula["certified"]
    assert by_data["travel_time_s"] == pytest.approx(by_formula["travel_time_s"], abs=1e-5)
    assert by_data["iterations"] <= 1.5 * by_formula["iterations"]
    assert by_data["n_variables"] == by_formula["n_variables"]
    assert by_data["interpreted_blocks"] == by_formula["interpreted_blocks"]


@pytest.mark.parametrize("compile", ["never", "auto"])
def test_second_derivatives_against_differences_of_scipys(recorded: Path, compile: str) -> None:
    """Between the rows, and on the straight lines before and after them."""
    function = expression(Spline(recorded))
    (found,) = derivatives([function], compile)  # type: ignore[arg-type]
    rows = np.loadtxt(recorded, delimiter=",", skiprows=1)
    theirs = CubicSpline(rows[:, 0], rows[:, 1:], bc_type="natural")
    weights, h = np.array([1.0, -2.0, 0.5, 3.0, 1.0, -1.0]), 1e-4

    def weighed(time: float) -> float:
        return float(weights @ np.concatenate([theirs(time), theirs(time, 1)]))

    for time in rows[[0, 20, 4999, -2], 0] + 0.4 * rows[1, 0]:  # the third derivative jumps at a row
        slope = np.zeros(6)
        slope[found.rows] = np.asarray(found.jacobian(time, [], 0.0)).ravel()
        np.testing.assert_allclose(slope, np.concatenate([theirs(time, 1), theirs(time, 2)]), atol=1e-9)
        curvature = np.asarray(found.hessian(time, [], 0.0, weights)).ravel()
        differences = (weighed(time + h) - 2 * weighed(time) + weighed(time - h)) / h**2
        np.testing.assert_allclose(curvature, differences, atol=2e-5)
    for beyond in (-3.0, 601.0):
        assert not np.any(np.asarray(found.hessian(beyond, [], 0.0, weights)))


def test_what_judges_a_plan_agrees_with_what_plans_it(recorded: Path) -> None:
    """Piecewise polynomials of SciPy in the certificate, B-splines of CasADi in the planner."""
    motion = Combined((Linear((0.0, 0.0, 0.1), (0.01, 0.0, 0.0)), Spline(recorded)))
    times = np.sort(np.random.default_rng(0).uniform(-5.0, 610.0, 500))
    for ours, theirs in zip(sample(motion, times), planned(motion, times), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-11)
    inside = times[(times > 0) & (times < 600)]
    np.testing.assert_allclose(sample(Spline(recorded), inside)[0], circle(inside), atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_declared_noise_is_taken_out(tmp_path: Path, seed: int) -> None:
    """What is left passes the rows by the noise and is several times nearer to the truth, in velocity by far."""
    draw = np.random.default_rng(seed)
    time = np.sort(draw.uniform(0.0, 10.0, 1000))
    noisy = circle(time) + draw.normal(0.0, NOISE, (1000, 3))
    file = written(tmp_path / "noisy.csv", time, noisy)
    smooth, rough = Spline(file, noise_m=NOISE), Spline(file)
    passed = sample(smooth, time)[0] - noisy
    assert np.sqrt(np.mean(passed**2)) == pytest.approx(NOISE, rel=0.01)
    assert np.sqrt(np.mean((sample(smooth, time)[0] - circle(time)) ** 2)) < NOISE / 4
    speed = np.linalg.norm(sample(smooth, time[20:-20])[1], axis=1)
    assert np.abs(speed - 0.12).max() < 0.012
    assert np.abs(np.linalg.norm(sample(rough, time)[1], axis=1) - 0.12).max() > 0.1, "as the noise has it"
    np.testing.assert_array_equal(rough.points[:, 1:], noisy)


def test_what_deviates_from_a_line_by_less_than_the_noise_is_a_line(tmp_path: Path) -> None:
    time = np.linspace(0.0, 5.0, 60)
    line = np.array([1.0, 0.0, 0.4]) + np.outer(time, [0.1, -0.2, 0.0])
    zigzag = line + 1e-4 * np.resize([1.0, -1.0], (60, 1))
    motion = Spline(written(tmp_path / "line.csv", time, zigzag), noise_m=NOISE)
    _, velocity = sample(motion, time)
    np.testing.assert_allclose(velocity, np.tile([0.1, -0.2, 0.0], (60, 1)), atol=2e-4)


def test_too_many_rows_and_noise_that_is_none(tmp_path: Path) -> None:
    time = np.arange(ROWS + 1.0)
    with pytest.raises(BadInput, match=f"{ROWS + 1} rows.*{ROWS}"):
        sample(Spline(written(tmp_path / "long.csv", time, circle(time))), np.zeros(1))
    short = written(tmp_path / "short.csv", time[:4], circle(time[:4]))
    with pytest.raises(BadInput, match="4 rows") as refused:
        sample(Spline(short, noise_m=NOISE), np.zeros(1))
    assert refused.value.field == "scenario.target.noise_m"
    for noise in (-NOISE, np.nan, np.inf):
        with pytest.raises(ValidationError):
            Spline(short, noise_m=noise)


def test_a_file_that_changes_is_read_again(tmp_path: Path) -> None:
    time = np.arange(4.0)
    file = written(tmp_path / "path.csv", time, circle(time))
    before = sample(Spline(file), time)[0]
    written(file, time, circle(time) + 1.0)
    np.testing.assert_allclose(sample(Spline(file), time)[0], before + 1.0, atol=1e-12)


def test_a_compiler_that_does_not_end_is_stopped_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    gcc, cache = tmp_path / "gcc", tmp_path / "cache"
    cache.mkdir(mode=0o700)
    gcc.write_text("#!/bin/sh\nwhile :; do :; done\n")
    gcc.chmod(0o755)
    monkeypatch.setenv("BENCHBENCH_CACHE", str(cache))
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.setattr("benchbench.mpcc.derivatives.LARGE", 0)
    ledger, smooth = Ledger(1.0), replace(by_hand()[0].mpcc, pairs=())
    with ledger.building():
        assert not assemble(smooth, seconds=1.0).compiled
    assert ledger.costs()["interpreted_blocks"] == ledger.interpreted > 0
    assert "time was up" in caplog.text
    assert not list(cache.rglob("block.so")) and not list(cache.rglob("block.c"))
