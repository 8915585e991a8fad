"""The flight that an exported ROS 2 file carries along as CSV: its messages have no place for thrusts."""

from __future__ import annotations

from pathlib import Path

NAME, KIND = "flight.csv", "text/csv"
"""Name and media type of the attachment."""


def attached(path: Path) -> str | None:
    """Return the CSV in an MCAP file, None where it has none or cannot be read."""
    try:
        from mcap.reader import make_reader

        with path.open("rb") as file:
            for one in make_reader(file, validate_crcs=True).iter_attachments():
                if one.name == NAME:
                    return one.data.decode()
    except Exception:  # noqa: BLE001  # the readers of a broken file fail in many ways, and another one says so
        return None
    return None
