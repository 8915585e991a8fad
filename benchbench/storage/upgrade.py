"""Where the columns of earlier versions of the record went."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

GAPS = {
    "contact_max_distance_m": ("position", "mm apart"),
    "contact_max_speed_gap_mps": ("velocity", "mm/s relative"),
    "contact_max_heading_error_rad": ("heading", "mrad off heading"),
}
"""Columns of versions 1 and 2 for the contacts there were, with the contact's name and words."""
NOW = ("contact_gaps", "contact_gaps_said")
"""Columns that say the same since version 3."""


def upgraded(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a record of any version with today's names."""
    if GAPS.keys().isdisjoint(values):
        return dict(values)
    found = {name: values[name] for name in GAPS if values.get(name) is not None}
    kept = {name: value for name, value in values.items() if name not in GAPS}
    if not found:
        return kept
    said = [f"{1e3 * v:.3g} {GAPS[name][1]}" for name, v in found.items() if isinstance(v, (int, float))]
    return kept | dict(zip(NOW, ({GAPS[name][0]: v for name, v in found.items()}, said), strict=True))
