"""What a plan must keep to be certified; the values and their reasons are in conf/certificate/task.yaml."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from benchbench.certificate.named import fitting
from benchbench.ocp.scenario import Finite, NonNegative, Positive


class ProblemLimits(BaseModel):
    """What a solution of any MPCC must keep; a problem that is no flight has no other limits.

    residual         largest violation of a bound, a constraint or the sign of a pair, scaled as the MPCC is
    complementarity  largest min(G, H) of a pair, scaled as it is; null: not asked
    product          largest G H of a pair, scaled as it is; null: not asked
    stationarity     whether the class of stationarity is found out and recorded: on, off, or auto, which is on
                     where the MPCC came ready-made and off for flights (10 s at N = 100). It certifies nothing
    stationarity_seconds
                     wall seconds after which what is not found out stays "undecided"
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    residual: Positive
    complementarity: Positive | None = None
    product: Positive | None = None
    stationarity: Literal["auto", "on", "off"] = "auto"
    stationarity_seconds: Positive = 10.0


class Limits(ProblemLimits):
    """Tolerances of the certificate of flights, the same for every dynamics, relaxation and solver.

    node                 rounding allowed for ends, limits, inputs, contacts at planned nodes, own unit
    contact_claim        a node whose progress index exceeds this claims to be in contact, 1
    contact_allowance    by contact name: how far the replay may exceed the contact's limit, its unit
    defect_position      an interval's replay may miss the next planned position by, m
    defect_angle         and the next planned angle by, rad
    defect_velocity      and the next planned velocity by, m/s
    defect_rate          and each of the next planned rates by, rad/s
    overshoot_position   the replay may leave the limits of a position by, m
    overshoot_angle      and of an angle by, rad
    rate_ratio           largest |velocity| over its limit on the replay, 1
    end_position         the replay may miss the end by, m
    end_angle            and each of its angles by, rad
    end_velocity_ratio   velocity left at the end of the replay over its limit, 1
    end_speed            velocity over or under the one asked for at a gate or the end of a race, m/s
    gate_position        a gate of a race may be missed by more than its radius by, m
    gate_heading         its heading may be missed by more than the planner may by, rad
    segment_position     the replay from one gate to the next may miss the planned place of the latter by, m
    objective            share of the objective by which the planner's may differ from the one counted again on the replay, where the
                         scenario has cost terms of its own; the trapezoidal rule at N = 25 is 0.3 % off, a wrong term much more
    restart_seconds      the replay starts again from the planned state after so long, s; null: never
    restart_beyond       but only of flights that last longer than this, s
    checks               further checks by name, an entry point of the group benchbench.checks or
                         package.module.function, each with its limit; true: it needs none; null: not asked
    """

    node: Positive
    contact_claim: Positive
    contact_allowance: dict[str, NonNegative] = Field(default_factory=dict)
    defect_position: Positive
    defect_angle: Positive
    defect_velocity: Positive = 0.01
    defect_rate: Positive = 0.05
    overshoot_position: NonNegative
    overshoot_angle: NonNegative
    rate_ratio: Positive
    end_position: Positive
    end_angle: Positive
    end_velocity_ratio: NonNegative
    end_speed: Positive = 0.05
    gate_position: NonNegative = 0.01
    gate_heading: NonNegative = 0.01
    segment_position: Positive = 0.01
    objective: Positive = 0.01
    restart_seconds: Positive | None = 2.0
    restart_beyond: NonNegative = 4.0
    checks: dict[str, Finite | Literal[True] | None] = Field(default_factory=dict)

    def restarts(self, travel_time: float) -> float | None:
        """After how many s the replay of a flight of so many s starts again; None: never."""
        return self.restart_seconds if travel_time > self.restart_beyond else None

    @model_validator(mode="after")
    def _checks_exist(self) -> Self:
        for name, limit in self.checks.items():
            if limit is not None:
                fitting(name, limit)
        return self
