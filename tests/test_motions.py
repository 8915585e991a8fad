"""Motions of targets: velocities, the paper's circle, splines against SciPy, bad files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.interpolate import CubicSpline

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.motion import Motion, sample
from benchbench.run import config
from benchbench_plugins.motions import Braking, Circle, Combined, Fixed, Linear, Spline

POINTS = np.array([[0.5, 1.0, 0.0, 0.4], [1.1, 1.2, 0.3, 0.45], [2.0, 1.1, 0.5, 0.5], [2.7, 0.8, 0.4, 0.4]])


def write(path: Path, table: Array, header: str = "t,x,y,z") -> Path:
    lines = [header, *(",".join(repr(float(x)) for x in row) for row in table)]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def spline(tmp_path: Path) -> Spline:
    return Spline(write(tmp_path / "path.csv", POINTS))


def tilted(**changes: object) -> Circle:
    fields = {
        "centre_m": (1.1, -0.2, 0.6), "radius_m": 0.4, "rate_radps": 0.7, "phase_rad": 0.3,
        "normal": (0.3, -0.5, 0.8), "first_axis": (1.0, 1.0, 0.2),
    }  # fmt: skip
    return Circle(**(fields | changes))


def all_motions(tmp_path: Path) -> list[Motion]:
    file = write(tmp_path / "path.csv", POINTS)
    circle, line = tilted(), Linear((0.9, 0.0, 0.4), (0.1, -0.2, 0.05))
    braking = Braking((0.2, 0.1, 0.4), (0.3, -0.4, 0.1), 2.51)
    return [
        Fixed((1.0, 0.0, 0.4)),
        line,
        circle,
        Spline(file),
        Combined((line, circle, Spline(file))),
        braking,
    ]


@pytest.mark.parametrize("which", range(6))
def test_velocity_is_the_rate_of_position(tmp_path: Path, which: int) -> None:
    motion = all_motions(tmp_path)[which]
    times = np.linspace(-1.03, 4.02, 41)
    h = 1e-3
    before, after = (sample(motion, times + s)[0] for s in (-h, h))
    far_before, far_after = (sample(motion, times + s)[0] for s in (-2 * h, 2 * h))
    slope = (far_before - 8 * before + 8 * after - far_after) / (12 * h)
    np.testing.assert_allclose(sample(motion, times)[1], slope, atol=2e-6)


def test_circle_in_any_plane_keeps_radius_plane_and_rate() -> None:
    circle = tilted()
    times = np.linspace(0, 20, 200)
    position, velocity = sample(circle, times)
    arm = position - circle.centre_m
    normal = np.array(circle.normal) / np.linalg.norm(circle.normal)
    np.testing.assert_allclose(np.linalg.norm(arm, axis=1), 0.4, rtol=1e-13)
    np.testing.assert_allclose(arm @ normal, 0.0, atol=1e-14)
    np.testing.assert_allclose(np.cross(arm, velocity), 0.4**2 * 0.7 * np.tile(normal, (200, 1)), atol=1e-13)


def test_a_braking_target_comes_to_rest_smoothly_and_stays() -> None:
    start, first, stop = np.array([0.2, 0.1, 0.4]), np.array([0.3, -0.4, 0.1]), 2.5
    times = np.linspace(-1, 6, 7001)
    position, velocity = sample(Braking(tuple(start), tuple(first), stop), times)
    speed = velocity @ first / (first @ first)
    np.testing.assert_allclose(velocity, np.outer(speed, first), atol=1e-14)
    assert np.all(np.diff(speed) <= 1e-15)
    np.testing.assert_allclose(speed[times <= 0], 1, atol=1e-14)
    np.testing.assert_allclose(speed[times >= stop], 0, atol=1e-14)
    np.testing.assert_allclose(
        position[times >= stop], np.tile(start + first * stop / 2, (3501, 1)), atol=1e-14
    )
    acceleration = np.gradient(speed, times)
    steepest = 6 / stop**2  # of the acceleration, which has no jump
    assert np.abs(np.diff(acceleration)).max() < 2 * steepest * 1e-3


def test_phase_is_measured_from_the_first_axis() -> None:
    (start,), _ = sample(tilted(phase_rad=0.0), np.zeros(1))
    arm, normal = start - (1.1, -0.2, 0.6), np.array([0.3, -0.5, 0.8])
    axis = np.array([1.0, 1.0, 0.2])
    axis -= axis @ normal / (normal @ normal) * normal
    np.testing.assert_allclose(arm, 0.4 * axis / np.linalg.norm(axis), atol=1e-14)


def test_scenario_circle_is_the_papers() -> None:
    """X = 0.4 sin(0.3 t) + 1.1, y = 0.4 cos(0.3 t), paper Eq. 34."""
    t = np.linspace(0, 30, 100)
    position, _ = sample(config.compose("+scenario=circle").scenario.target, t)
    wanted = np.stack([0.4 * np.sin(0.3 * t) + 1.1, 0.4 * np.cos(0.3 * t), np.full_like(t, 0.4)], axis=1)
    np.testing.assert_allclose(position, wanted, atol=1e-14)


@pytest.mark.parametrize(
    "changes",
    [{"normal": (0, 0, 0)}, {"first_axis": (0.6, -1.0, 1.6)}, {"radius_m": 0.0}, {"radius_m": -1.0},
     {"rate_radps": np.nan}, {"centre_m": (0.0, np.inf, 0.0)}, {"centre_m": (0.0, 0.0)}],
)  # fmt: skip
def test_impossible_circle_is_refused(changes: dict[str, object]) -> None:
    with pytest.raises((BadInput, ValidationError)):
        tilted(**changes)


def test_linear_and_fixed() -> None:
    t = np.array([0.0, 2.5])
    position, velocity = sample(Linear((0.9, 0.0, 0.4), (0.1, -0.2, 0.0)), t)
    np.testing.assert_allclose(position, [[0.9, 0, 0.4], [1.15, -0.5, 0.4]])
    np.testing.assert_allclose(velocity, [[0.1, -0.2, 0.0]] * 2)
    position, velocity = sample(Fixed((1.0, 2.0, 3.0)), t)
    np.testing.assert_array_equal(position, [[1.0, 2.0, 3.0]] * 2)
    np.testing.assert_array_equal(velocity, np.zeros((2, 3)))


def test_combined_is_the_sum(tmp_path: Path) -> None:
    *parts, combined, _ = all_motions(tmp_path)
    t = np.linspace(-1, 4, 23)
    for which in (0, 1):
        total = sum(sample(part, t)[which] for part in parts[1:])
        np.testing.assert_allclose(sample(combined, t)[which], total, atol=1e-13)
    assert len(combined.parameters) == sum(len(part.parameters) for part in parts[1:])


def test_combined_of_nothing_stands_at_the_origin() -> None:
    position, velocity = sample(Combined(()), np.array([0.0, 1.0]))
    assert not np.any(position) and not np.any(velocity)


def test_spline_equals_scipys_natural_one(spline: Spline) -> None:
    theirs = CubicSpline(POINTS[:, 0], POINTS[:, 1:], bc_type="natural")
    t = np.linspace(POINTS[0, 0], POINTS[-1, 0], 301)
    position, velocity = sample(spline, t)
    np.testing.assert_allclose(position, theirs(t), atol=1e-12)
    np.testing.assert_allclose(velocity, theirs(t, 1), atol=1e-11)
    np.testing.assert_allclose(sample(spline, POINTS[:, 0])[0], POINTS[:, 1:], atol=1e-13)


def test_spline_goes_on_straight(spline: Spline) -> None:
    theirs = CubicSpline(POINTS[:, 0], POINTS[:, 1:], bc_type="natural")
    for end, beyond in (
        (POINTS[0, 0], np.array([-3.0, 0.0, 0.49])),
        (POINTS[-1, 0], np.array([2.71, 5.0, 40.0])),
    ):
        position, velocity = sample(spline, beyond)
        wanted = theirs(end) + (beyond - end)[:, None] * theirs(end, 1)
        np.testing.assert_allclose(position, wanted, atol=1e-11)
        np.testing.assert_allclose(velocity, np.tile(theirs(end, 1), (3, 1)), atol=1e-12)


def test_spline_is_twice_continuously_differentiable(spline: Spline) -> None:
    """Across every knot, both ends included; the natural spline's curvature is zero there."""
    e = 1e-5
    for knot in POINTS[:, 0]:
        (left, right), (v_left, v_right) = sample(spline, np.array([knot - e, knot + e]))
        np.testing.assert_allclose(left, right, atol=1e-4)
        np.testing.assert_allclose(v_left, v_right, atol=2e-4)
        _, (a, b, c, d) = sample(spline, np.array([knot - 2 * e, knot - e, knot + e, knot + 2 * e]))
        np.testing.assert_allclose((b - a) / e, (d - c) / e, atol=1e-3)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("t,x,y,z\n0,1,2,3\n1,1,2,3\n1,2,2,3\n", "increas"),
        ("t,x,y,z\n0,1,2,3\n2,1,2,3\n1,2,2,3\n", "increas"),
        ("t,x,y,z\n0,1,2,3\n1,1,2,3\n", "3 rows"),
        ("t,x,y,z\n0,1,2\n1,1,2\n2,1,2\n", "t,x,y,z"),
        ("t,x,y,z\n0,1,2,nan\n1,1,2,3\n2,2,2,3\n", "finite"),
        ("t,x,y,z\n0,1,2,inf\n1,1,2,3\n2,2,2,3\n", "finite"),
        ("t,x,y,z\n0,1,2,three\n1,1,2,3\n2,2,2,3\n", "three"),
        ("t,x,y,z\n0,1,2,3\n1,1,2\n2,2,2,3\n", "column"),
        ("0,1,2,3\n1,1,2,3\n2,2,2,3\n3,2,2,3\n", "header"),
        ("", "header"),
        ("t,x,y,z\n", "3 rows"),
    ],
)
def test_bad_csv_is_bad_input(tmp_path: Path, content: str, says: str) -> None:
    file = tmp_path / "path.csv"
    file.write_text(content)
    with pytest.raises(BadInput, match=says) as refused:
        sample(Spline(file), np.zeros(1))
    assert refused.value.field == "scenario.target.csv"


def test_missing_csv_is_bad_input(tmp_path: Path) -> None:
    for path in (tmp_path / "nowhere.csv", tmp_path):
        with pytest.raises(BadInput, match="cannot read"):
            sample(Spline(path), np.zeros(1))


def test_binary_file_is_bad_input(tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    file.write_bytes(bytes(range(256)) * 4)
    with pytest.raises(BadInput):
        sample(Spline(file), np.zeros(1))
