"""A figure as a PNG file, drawn once: `savefig` goes through a first drawing only to lay the page out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imsave

DPI = 150


def write_png(figure: Figure, path: Path) -> None:
    """Draw a figure, its layout included, and write it with DPI pixels per inch; packed lightly, which is faster."""
    figure.set_dpi(DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    imsave(path, pixels, format="png", dpi=DPI, pil_kwargs={"compress_level": 1})
