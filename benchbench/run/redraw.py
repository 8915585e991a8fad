"""The picture of a stored plan, drawn again where its run could not."""

from __future__ import annotations

import logging
from pathlib import Path

from benchbench.run.failure import reason
from benchbench.storage.configuration import configuration
from benchbench.storage.files import PICTURE, PLAN, RECORD

LOG = logging.getLogger(__name__)


def redraw(folder: Path) -> bool:
    """Draw the picture that a run was to have and has not; returns whether there is one now that was not before.

    A plan that cannot be shown is said so and costs nothing else.
    """
    tree = configuration(folder)
    if tree is None or tree.get("picture") is not True or (folder / PICTURE).exists():
        return False
    if not (folder / PLAN).is_file():
        return False
    try:
        _draw(folder, tree)
    except Exception as error:  # noqa: BLE001  # it was written by another version, plugin or program
        LOG.warning("the picture of '%s' is missing and cannot be drawn: %s", folder, reason(error))
        return False
    return True


def _draw(folder: Path, tree: dict[str, object]) -> None:
    from benchbench.report.caption import caption
    from benchbench.report.picture import draw
    from benchbench.run.stored import scene_parts
    from benchbench.storage.playback import read_mcap
    from benchbench.storage.table import load_record

    recording = read_mcap(folder / PLAN)
    scenario, model = scene_parts(tree)
    title, verdict = caption(load_record(folder / RECORD))
    draw(folder / PICTURE, recording.plan, scenario, model, recording.flight, title, verdict)
