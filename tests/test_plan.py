"""Plans: how inputs are interpolated, against SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BPoly

from benchbench.ground.arrays import Array
from benchbench.ocp.plan import Interpolation, Plan

RNG = np.random.default_rng(4)
TIME = np.array([0.0, 0.1, 0.4, 0.5])
INSIDE = RNG.uniform(0.0, 0.5, 100)


def plan(interpolation: Interpolation, inputs: Array) -> Plan:
    """A plan of one coordinate and two inputs on three intervals."""
    zero = np.zeros((4, 1))
    return Plan(TIME, zero, zero, inputs, np.zeros(4), interpolation, ("x",), ("m",), ("a", "b"), ("N", "N"))


def test_held_inputs_are_the_row_of_the_interval() -> None:
    inputs = RNG.normal(size=(3, 2))
    row = np.digitize(INSIDE, TIME[1:-1])
    assert np.array_equal(plan("hold", inputs).input_at(INSIDE), inputs[row])


def test_linear_inputs_are_interpolated() -> None:
    inputs = RNG.normal(size=(4, 2))
    expected = np.stack([np.interp(INSIDE, TIME, column) for column in inputs.T], axis=-1)
    assert np.allclose(plan("linear", inputs).input_at(INSIDE), expected, atol=1e-14)


@pytest.mark.parametrize("points", [2, 3, 5])
def test_bezier_inputs_are_bernstein_polynomials_within_their_control_points(points: int) -> None:
    inputs = RNG.normal(size=(3 * points, 2))
    found = plan("bezier", inputs).input_at(INSIDE)
    pieces = inputs.reshape(3, points, 2)
    assert np.allclose(found, BPoly(pieces.transpose(1, 0, 2), TIME)(INSIDE), atol=1e-13)
    row = np.digitize(INSIDE, TIME[1:-1])
    assert np.all(found <= pieces.max(axis=1)[row] + 1e-14)
    assert np.all(found >= pieces.min(axis=1)[row] - 1e-14)


@pytest.mark.parametrize(("interpolation", "rows"), [("hold", 4), ("linear", 3), ("bezier", 7)])
def test_a_wrong_number_of_rows_is_refused(interpolation: Interpolation, rows: int) -> None:
    with pytest.raises(ValueError, match="inputs"):
        plan(interpolation, np.zeros((rows, 2)))
