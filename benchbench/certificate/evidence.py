"""The evidence about a plan, made once: what every check looks at, whatever the kind of scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from benchbench.certificate.limited import Limited
from benchbench.certificate.limits import Limits
from benchbench.certificate.replay import Defects, Replay
from benchbench.ground.arrays import Array
from benchbench.mpcc.residuals import Residuals
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario


@dataclass(frozen=True)
class Given:
    """What is judged: a plan, the vehicle and the limits; residuals of the original MPCC, where there is one."""

    plan: Plan
    model: Model
    limits: Limits
    residuals: Residuals | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence(Given):
    """Everything that can be measured on a plan; kinds of scenarios add their own (contacts, gates).

    plant    the vehicle as it is flown, written apart from the model
    missed   state at the end of each interval, flown from its planned first state, minus the planned one:
             every position, angle and velocity
    flight   dense replay of the inputs, open loop but for its restarts; NaN after a breakdown
    planned  what has limits at the nodes, by kind: configuration, velocity, input, output
    room     what has limits of position or angle, on the replay
    rates    velocities, and outputs that are rates, on the replay
    """

    scenario: Scenario
    plant: Plant
    missed: Defects
    flight: Replay
    planned: Mapping[str, Limited]
    room: Limited
    rates: Limited

    @property
    def drift(self) -> Array:
        """Configuration on the replay at the nodes minus the planned one, (N + 1, n_q)."""
        return self.flight.configuration[self.flight.nodes] - self.plan.configuration

    def at(self, k: int) -> str:
        """Where a sample of the replay stands, as a sentence says it."""
        return f" on the replay at t={self.flight.time[k]:.3f} s"
