"""A vehicle that its surroundings push: forces of contact as inputs that complementarity chooses."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping

import casadi as ca

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model


class TouchingModel(Model):
    """A model that touches walls or ground. Some of its inputs are no motor's, but forces of contact.

    Planners find them by complementarity at every node. The plant knows nothing of it: it finds the forces itself, from where it
    is, whatever a plan says they are.
    """

    @property
    @abstractmethod
    def touches(self) -> tuple[str, ...]:
        """Names of the inputs that are forces of contact."""

    @abstractmethod
    def contact(self, q: ca.SX, v: ca.SX, u: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Return G and H, (m,) each and of order one, of 0 <= G perpendicular to H >= 0: forces, and how far from touching."""

    @property
    @abstractmethod
    def surroundings(self) -> Mapping[str, Array]:
        """What is touched, to be drawn: lines (n, 3) m by what is written there; rows of NaN part them."""


def motors(model: Model) -> list[int]:
    """Positions of the inputs that motors give."""
    forces = model.touches if isinstance(model, TouchingModel) else ()
    return [i for i, name in enumerate(model.inputs.names) if name not in forces]
