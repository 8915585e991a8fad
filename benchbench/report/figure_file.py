"""A figure as a file for papers and slides: the format is that of the file's name."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from benchbench.report.png import write_png
from benchbench.report.style import RC
from benchbench.storage.files import write_bytes

STILL = (".png", ".pdf", ".svg")
EMBEDDED: dict[Any, Any] = {"pdf.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": "benchbench"}
"""Journals refuse PDFs with Type 3 fonts; letters of an SVG are drawn, so that it looks the same where a font is missing."""
UNDATED: dict[str, dict[str, Any]] = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
"""The same figure gives the same file, also tomorrow."""


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, PDF or SVG; raises KeyError for another name, BadInput where the file system refuses."""
    sink = BytesIO()
    if path.suffix.lower() == ".png":
        write_png(figure, sink)
    else:
        kind = path.suffix.lower()
        with mpl.rc_context(RC | EMBEDDED):
            figure.savefig(sink, format=kind[1:], metadata=UNDATED[kind])
    write_bytes(path, sink.getvalue())
