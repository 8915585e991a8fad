"""A figure as PNG, in a file or by itself in a notebook, drawn once: `savefig` goes through a first drawing only to lay the page out."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import BinaryIO, final

import matplotlib as mpl
import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imsave

from benchbench.report.style import RC

DPI = 150
SCREEN_DPI = 75
"""Pixels per inch in a notebook, whose columns are some 1000 px wide."""


@final
class Picture(Figure):
    """A figure that a notebook shows by itself, where a plain one needs pyplot.

    It has our style whenever it is drawn: matplotlib makes ticks, and measures their labels, at the first drawing,
    in the style of that moment.
    """

    def draw(self, renderer: RendererBase) -> None:
        """Draw it in our style."""
        with mpl.rc_context(RC):
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        sink = BytesIO()
        write_png(self, sink, SCREEN_DPI)
        return sink.getvalue()


def write_png(figure: Figure, place: Path | BinaryIO, dpi: int = DPI) -> None:
    """Draw a figure, its layout included, and write it with `dpi` pixels per inch; packed lightly, which is faster."""
    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    imsave(place, pixels, format="png", dpi=dpi, pil_kwargs={"compress_level": 1})
