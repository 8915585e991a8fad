"""Colours keep apart for readers who do not see red or green: simulated, as Machado, Oliveira and Fernandes do."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from benchbench.ground.arrays import Array
from benchbench.report import style
from benchbench.report.html.charts import cost_split, failures

VISION = {
    "all": np.eye(3),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
}  # fmt: skip
"""Linear RGB as it is seen; severity 1.0 of Machado et al. 2009, doi:10.1109/TVCG.2009.113."""
APART = 12.0
"""Distance in CIE Lab (1976): 2.3 is just noticeable, beyond 10 colours are told apart at a glance."""
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
"""From linear sRGB; the white is D65 (IEC 61966-2-1)."""
PALETTES = {
    "curves and methods": style.CURVES,
    "vehicle, arm, end effector, target, replay": (style.FRAME, style.ARM, style.TOOL, style.TARGET, style.INK),
    "verdicts": (style.GOOD, style.BAD),
    "outcomes": tuple(failures.COLORS.values()),
    "work": tuple(
        cost_split.COLORS[name]
        for name in ("assembly", "derivatives", "build", "function evaluations", "linear algebra, rest", "solver", "certificate")
    ),
    "steps": tuple(cost_split.COLORS[name] for name in ("guess", "homotopy", "last solve", "solver")),
}  # fmt: skip


def lab(colour: str, vision: str) -> Array:
    """CIE Lab of a colour like #0072B2 as it is seen."""
    values = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    x = XYZ @ np.clip(VISION[vision] @ linear, 0.0, 1.0) / WHITE
    f = np.where(x > 216 / 24389, np.cbrt(x), (24389 / 27 * x + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def distance(one: str, other: str, vision: str) -> float:
    return float(np.linalg.norm(lab(one, vision) - lab(other, vision)))


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize("palette", PALETTES)
def test_colours_of_one_chart_keep_apart(palette: str, vision: str) -> None:
    near = {(a, b): round(distance(a, b, vision), 1) for a, b in combinations(PALETTES[palette], 2)}
    assert min(near.values()) > APART, sorted(near.items(), key=lambda one: one[1])[:3]


def test_the_simulation_confuses_what_is_confused() -> None:
    """Greys stay what they are; a pink and a grey are one to who sees no green, and two to others."""
    for vision in VISION:
        assert np.abs(lab("#808080", vision)[1:]).max() < 0.1
    assert lab("#FFFFFF", "all") == pytest.approx([100, 0, 0], abs=0.01)
    assert lab("#FF0000", "all") == pytest.approx([53.24, 80.09, 67.20], abs=0.02), (
        "as published for sRGB red"
    )
    assert distance("#CC79A7", "#9A9A9A", "deuteranopia") < APART < distance("#CC79A7", "#9A9A9A", "all")
