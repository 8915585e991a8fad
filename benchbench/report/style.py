"""Colours and type sizes of the pictures; the colours keep apart for colour-blind readers (Okabe & Ito 2008).

`tests/test_colours.py` asks that of every change, for three kinds of colour blindness.
"""

from __future__ import annotations

from typing import Any

FRAME, ARM, TOOL, TARGET = "#0072B2", "#009E73", "#C8508F", "#7A7A00"
CONTACT = "#22C3D6"
LIMIT = "#555555"
INK, FAINT = "#1A1A1A", "#8A8A8A"
GOOD, BAD = "#00704F", "#B23A00"
CERTIFIED = "certified"
"""What the verdict on a certified plan begins with."""
CURVES = ("#0072B2", "#D55E00", "#009E73", "#C8508F", "#E69F00", "#1A1A1A")

RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 5,
    "axes.labelsize": 9,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.6,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "text.color": INK,
    "lines.solid_capstyle": "round",
}


def verdict_colour(verdict: str) -> str:
    """Green for a certified plan, whatever is said beside it."""
    return GOOD if verdict.startswith(CERTIFIED) else BAD
