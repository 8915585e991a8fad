"""The picture of a stored plan, drawn when it is asked for."""

from __future__ import annotations

import logging
from pathlib import Path

from benchbench.errors import BadInput
from benchbench.run.failure import reason
from benchbench.storage.configuration import configuration
from benchbench.storage.files import CONFIG, PICTURE, PLAN, RECORD

LOG = logging.getLogger(__name__)


def redraw(folder: Path) -> Path | None:
    """Draw the picture of a run with a plan that has none yet, and return it; None where there is nothing to do.

    A plan that cannot be shown is said so and costs nothing else.
    """
    if (folder / PICTURE).exists() or not (folder / PLAN).is_file():
        return None
    try:
        return draw_stored(folder)
    except Exception as error:  # noqa: BLE001  # it was written by another version, plugin or program
        LOG.warning("the picture of '%s' is missing and cannot be drawn: %s", folder, reason(error))
        return None


def draw_stored(folder: Path) -> Path:
    """Draw the picture of a run from its plan, configuration and record, and return it.

    Raises BadInput where one of them cannot be used, Unavailable without the package mcap.
    """
    from benchbench.report.caption import caption
    from benchbench.report.picture import draw
    from benchbench.run.stored import scene_parts
    from benchbench.storage.playback import read_mcap
    from benchbench.storage.table import load_record

    if (tree := configuration(folder)) is None:
        raise BadInput(str(folder), f"has no {CONFIG} that can be read", "the folder of a run")
    try:
        recording, record = read_mcap(folder / PLAN), load_record(folder / RECORD)
    except (OSError, ValueError, TypeError) as error:
        raise BadInput(str(folder), f"cannot be read: {error}", f"a run's {PLAN} and {RECORD}") from None
    scenario, model = scene_parts(tree)
    draw(folder / PICTURE, recording.plan, scenario, model, recording.flight, *caption(record))
    return folder / PICTURE
