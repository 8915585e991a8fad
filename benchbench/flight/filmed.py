"""A world that can be looked at: pictures of where everything was."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass

from numpy import uint8
from numpy.typing import NDArray

from benchbench.flight.rig import Rig
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe

WIDTH, HEIGHT = 640, 480
"""Pixels of a picture."""


@dataclass(frozen=True)
class Scene:
    """A flight as it is shown, a row for each picture.

    state (n, 15) as `Truth.state`; ball (n, 3) m, its centre; stand (n, 3) m, where the stand holds that
    ball_radius m, and reach m of the magnet
    """

    airframe: Airframe
    rig: Rig
    ball_radius: float
    reach: float
    state: Array
    ball: Array
    stand: Array


class Filmed(ABC):
    """What a world is besides, if it can show itself."""

    @abstractmethod
    def pictures(self, scene: Scene) -> Iterator[NDArray[uint8]]:
        """Yield pictures (HEIGHT, WIDTH, 3) in red, green and blue. Raises Unavailable, with the reason, where none can be made."""
