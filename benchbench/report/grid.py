"""Where plots stand on a page: fixed margins in inches, where matplotlib's layout engines draw all text twice to measure it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.transforms import ScaledTranslation

TITLE_IN, TICKS_IN, LABEL_IN = 0.28, 0.25, 0.20
"""Heights of a title above a plot, of the numbers below it, of what is written below them."""
NUMBERS_IN = 0.46
"""Width of the numbers at the left of a plot."""


def label_axes(axes: Axes, below: float = 0.0, beside: float = 0.0) -> None:
    """Write the labels of the axes so far (in) from the plot, where matplotlib would measure all numbers to find a place."""
    inches = axes.figure.dpi_scale_trans
    axes.xaxis.set_label_coords(0.5, 0.0, axes.transAxes + ScaledTranslation(0.0, -below, inches))
    axes.yaxis.set_label_coords(0.0, 0.5, axes.transAxes + ScaledTranslation(-beside, 0.0, inches))


@dataclass(frozen=True)
class Margins:
    """What is left free around plots, and between their rows and columns, in inches."""

    left: float = NUMBERS_IN
    right: float = 0.09
    top: float = TITLE_IN
    bottom: float = TICKS_IN + LABEL_IN
    between_rows: float = TICKS_IN + TITLE_IN
    between_columns: float = NUMBERS_IN + 0.06

    def grid(self, figure: Figure | SubFigure, rows: int, columns: int) -> dict[str, Any]:
        """Return `gridspec_kw` of `figure.subplots(rows, columns)`; plots never vanish, however small the figure."""
        width, height = figure.bbox.width / figure.dpi, figure.bbox.height / figure.dpi
        wide = (width - self.left - self.right - (columns - 1) * self.between_columns) / columns
        high = (height - self.top - self.bottom - (rows - 1) * self.between_rows) / rows
        return {
            "left": self.left / width, "right": 1 - self.right / width,
            "top": 1 - self.top / height, "bottom": self.bottom / height,
            "wspace": self.between_columns / wide, "hspace": self.between_rows / high,
        }  # fmt: skip
