"""What every predictor must do: follow a line, bear noise, keep to its clock, its kind of motion and nothing but what it saw."""

from __future__ import annotations

import numpy as np

from benchbench.conformance.checks.require import require
from benchbench.flight.predictor import Predictor, Seen
from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion, same_kind, sample

START, WAY = np.array([0.4, -0.3, 0.35]), np.array([0.12, 0.05, 0.0])
"""m and m/s."""
NOISE, TURNED = 0.01, 0.0087
"""m and rad of what is seen: a centimetre and half a degree."""
DRAWS = 20


def check_line(predictor: Predictor) -> None:
    """Without noise, a target on a straight line is within 5 mm where the plan begins and 2 cm a second later.

    However long before the last observation was made.
    """
    for late in (0.06, 0.3):
        if (motion := predictor.predict(_seen(late=late))) is None:
            return
        times = np.array([0.0, 1.0])
        off = np.linalg.norm(sample(motion, times)[0] - _line(times), axis=1)
        said = f"a target on a line, last seen {late} s before, is {off[0]:.3g} m off now and {off[1]:.3g} m a second later"
        require(bool(off[0] < 0.005 and off[1] < 0.02), said)


def check_noise(predictor: Predictor) -> None:
    """With noise on both, its error now is below the noise of one observation, and that of its velocity below 0.03 m/s."""
    found = []
    for draw in range(DRAWS):
        if (motion := predictor.predict(_seen(np.random.default_rng(draw)))) is None:
            return
        place, way = sample(motion, np.zeros(1))
        found.append([np.linalg.norm(place - START), np.linalg.norm(way - WAY)])
    off = np.sqrt(np.mean(np.square(found), axis=0))
    require(bool(off[0] < NOISE), f"with noise of {NOISE} m the target is {off[0]:.3g} m off")
    require(bool(off[1] < 0.03), f"with noise of {NOISE} m its velocity is {off[1]:.3g} m/s off")


def check_one_kind(predictor: Predictor) -> None:
    """Few observations give the kind of motion that many give: a planner is built once for it."""
    few, many = predictor.predict(_seen(count=8)), predictor.predict(_seen())
    if few is None or many is None:
        require(few is many, "it knows the target from some observations and predicts it from others")
        return
    require(same_kind(few, many), "8 and 100 observations give motions of two kinds")


def check_nowhere_special(predictor: Predictor) -> None:
    """What is seen elsewhere and turned about the vertical is predicted there and turned so: nothing else is read."""
    turn, away = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), np.array([2.0, -1.0, 0.1])
    seen = _seen(np.random.default_rng(7))
    there = Seen(seen.time, seen.position @ turn.T + away, seen.heading + np.pi / 2)
    one, other = predictor.predict(seen), predictor.predict(there)
    if one is None or other is None:
        return
    times = np.linspace(0.0, 2.0, 5)
    gap = float(np.abs(sample(one, times)[0] @ turn.T + away - sample(other, times)[0]).max())
    require(gap < 1e-6, f"the same elsewhere is predicted {gap:.3g} m differently")


def check_fresh(predictor: Predictor) -> None:
    """What it predicted before changes nothing."""
    first = predictor.predict(_seen())
    predictor.predict(_seen(np.random.default_rng(3), count=40))
    again = predictor.predict(_seen())
    same = (first is None and again is None) or bool(
        isinstance(first, Motion)
        and isinstance(again, Motion)
        and np.allclose(first.parameters, again.parameters, atol=1e-9)
    )
    require(same, "the same observations give another motion after others were seen")


CHECKS = (check_line, check_noise, check_one_kind, check_nowhere_special, check_fresh)


def _line(times: Array) -> Array:
    return START + times[:, None] * WAY


def _seen(noise: np.random.Generator | None = None, count: int = 100, late: float = 0.06) -> Seen:
    """The target on its line, seen 50 times a second."""
    times: Array = -late - 0.02 * np.arange(count, dtype=float)[::-1]
    heading = np.full(count, np.arctan2(WAY[1], WAY[0]))
    if noise is None:
        return Seen(times, _line(times), heading)
    return Seen(
        times, _line(times) + noise.normal(0.0, NOISE, (count, 3)), heading + noise.normal(0.0, TURNED, count)
    )
