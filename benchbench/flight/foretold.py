"""Can a predictor follow the target of a scenario at all? Asked before anything is planned."""

from __future__ import annotations

import numpy as np

from benchbench.flight.from_plan import LEAD
from benchbench.flight.mismatch import Mismatch
from benchbench.flight.predictor import Predictor
from benchbench.flight.sight import Sight
from benchbench.ground.errors import BadInput
from benchbench.ocp.motion import Motion, sample

NEAR, ALONG = 0.02, 0.05
"""m and m/s by which a motion predicted without noise may be off what was seen last: what the magnet and the judge allow."""
ALLOWED = "known, or a predictor whose motions are near those of the target"


def foretold(predictor: Predictor, name: str, target: Motion) -> Motion | None:
    """Return what is predicted when the plan begins, without noise; None where nothing is. Raises BadInput("predictor", ...)."""
    seen = Sight(target, Mismatch().draw(0), -LEAD, 0.0).seen(0.0, 0.0)
    motion = predictor.predict(seen)
    if motion is None:
        return None
    now = np.zeros(1)
    (place, way), (found, speed) = sample(target, now), sample(motion, now)
    off = (float(np.linalg.norm(found - place)), float(np.linalg.norm(speed - way)))
    if not (off[0] <= NEAR and off[1] <= ALONG):  # NaN is not near
        problem = f"'{name}' cannot give this target's kind of motion: {off[0]:.2g} m and {off[1]:.2g} m/s off where it was seen last"
        raise BadInput("predictor", problem, ALLOWED)
    return motion
