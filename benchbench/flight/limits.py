"""What a flight must keep to be a success; the values and their reasons are in conf/certificate/flight.yaml."""

from __future__ import annotations

from typing import Annotated, final

from pydantic import BaseModel, ConfigDict, Field

from benchbench.ocp.scenario import NonNegative, Positive


@final
class FlightLimits(BaseModel):
    """SI units.

    early, late      s by which the first attachment may come before the plan is within reach, and after its window
    touch_speed      m/s of the end effector relative to the ball where the magnet begins to act
    heading          rad between nose and way of the target there, where the target moves
    slow             m/s, a slower target has no heading
    controller_late  share of the commands that may take longer than until the next one, in CPU time
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    early: NonNegative
    late: NonNegative
    touch_speed: Positive
    heading: Positive
    slow: Positive
    controller_late: Annotated[float, Field(ge=0, le=1)]
