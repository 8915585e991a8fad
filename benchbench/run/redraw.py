"""The picture of a stored plan, drawn when it is asked for."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchbench.ground.errors import BadInput
from benchbench.run.failure import reason
from benchbench.storage.configuration import configuration
from benchbench.storage.files import CONFIG, PICTURE, PLAN, RECORD

if TYPE_CHECKING:
    from benchbench.ocp.model import Model
    from benchbench.ocp.scenario import Scenario
    from benchbench.storage.playback import Recording

LOG = logging.getLogger(__name__)


@dataclass(frozen=True)
class Drawable:
    """All that a picture of a stored plan is drawn of."""

    recording: Recording
    scenario: Scenario
    model: Model
    record: Mapping[str, Any]

    @classmethod
    def of(cls, folder: Path) -> Drawable:
        """Read a run's folder. Raises BadInput where something cannot be used, Unavailable without the package mcap."""
        from benchbench.run.stored import scene_parts
        from benchbench.storage.playback import read_mcap
        from benchbench.storage.table import load_record

        if (tree := configuration(folder)) is None:
            raise BadInput(str(folder), f"has no {CONFIG} that can be read", "the folder of a run")
        try:
            recording, record = read_mcap(folder / PLAN), load_record(folder / RECORD)
        except (OSError, ValueError, TypeError) as error:
            raise BadInput(str(folder), f"cannot be read: {error}", f"a run's {PLAN} and {RECORD}") from None
        return cls(recording, *scene_parts(tree), record)


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


def draw_stored(folder: Path, output: Path | None = None, fps: float = 20.0) -> Path:
    """Draw a run from its plan, configuration and record: its plan.png, or `output`, a film where it is .gif or .mp4.

    Raises BadInput where one of them cannot be used or for another format, Unavailable without what it takes.
    """
    from benchbench.report.caption import caption
    from benchbench.report.figure_file import STILL, write_figure
    from benchbench.report.film import MOVING, film
    from benchbench.report.picture import draw, figure
    from benchbench.report.scene import scene

    if output is not None and output.suffix.lower() not in (*STILL, *MOVING):
        raise BadInput("--output", f"cannot tell the format of '{output.name}'", ", ".join((*STILL, *MOVING)))
    found = Drawable.of(folder)
    plan, flown = found.recording.plan, found.recording.flight
    title, verdict = caption(found.record)
    if output is None:
        draw(folder / PICTURE, plan, found.scenario, found.model, flown, title, verdict)
        return folder / PICTURE
    if output.suffix.lower() in MOVING:
        film(output, scene(plan, found.scenario, found.model, flown), found.scenario, flown, title, fps)
    else:
        write_figure(figure(plan, found.scenario, found.model, flown, title, verdict), output)
    return output
