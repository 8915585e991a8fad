"""What the model does not know of a vehicle's acceleration: learned from flights, watched in flight, predicted ahead."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, final

import numpy as np
from pydantic import Field

from benchbench.ground.arrays import Array

NODE = 10
"""Numbers of a predicted state: position m, quaternion w x y z, velocity m/s (world)."""


@dataclass(slots=True)
class Sample:
    """One acceleration that was not expected.

    time          s
    state         (15,) as `Truth.state`, as sensed
    acceleration  (3,) m/s^2, world: measured, minus that of the model without any correction
    """

    time: float
    state: Array
    acceleration: Array


class Correction(ABC):
    """What is known of the residual acceleration in one flight."""

    @abstractmethod
    def observe(self, sample: Sample) -> None:
        """Hear of an acceleration that was not expected."""

    @abstractmethod
    def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
        """Return the residual acceleration (n, 3) m/s^2, world, at states (n, NODE) with arm angles (n,) rad.

        Beside it its gradient (n, 3, NODE) with respect to the states, None for none.
        """


Learned = Callable[[], Correction]
"""Begins a flight: each has a correction of its own."""


Training = Annotated[float, Field(gt=0, le=600, allow_inf_nan=False)]
"""s of a training flight; ten minutes are more than a battery lasts."""


class Residual(ABC):
    """A model of the residual acceleration.

    training  s of separate flights in the same world that it learns from; 0 for one that learns nothing before
    """

    training: float = 0.0

    @abstractmethod
    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Learn from the samples of training flights. Raises BadInput where it needs flights and there are none."""


@final
class Recorder(Correction):
    """Predicts nothing and keeps all samples: what flies training flights."""

    def __init__(self) -> None:
        self.samples: list[Sample] = []

    def observe(self, sample: Sample) -> None:
        """Keep it."""
        self.samples.append(sample)

    def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
        """Nothing."""
        return np.zeros((len(nodes), 3)), None
