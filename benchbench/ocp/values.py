"""Plain values of scenarios with what they may be: read without numpy, CasADi or any plugin, so that a slip is told at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from benchbench.ground import registry
from benchbench.ocp.sizes import GATES, Intervals, Nodes

FIELD = "kind"
"""Field of a configuration that names its kind, where no field of its own does."""
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, lt=1)]
Aim = Annotated[float, Field(gt=0, le=1)]
Order = Literal["fixed", "free"]
Visit = Literal["all", "one", "optional"]


def _increasing(pair: tuple[float, float]) -> tuple[float, float]:
    if not pair[0] <= pair[1]:
        raise ValueError("the first number must not exceed the second")
    return pair


Range = Annotated[tuple[float, float], AfterValidator(_increasing)]


class FlightValues(BaseModel):
    """What every kind of scenario has.

    start, end         coordinates by name (m, rad); what is not named is 0
    start_velocity     velocities at the start by coordinate name (m/s, rad/s); what is not named is 0
    travel_time        allowed travel time [s, s]
    travel_time_guess  first guess of the travel time in s
    input_cost         c_u of the paper's cost t_N + c_u sum h |u - u_ref|^2, in 1/unit^2
    workspace          limits of coordinates by name that belong to the room, not to the vehicle
    rate_margin        share of a velocity limit that the planner leaves unused, by coordinate name: a
                       transcription keeps limits at its nodes, and the plan is judged by what is flown
    kept_margins       names of margins (rate_margin.arm) that hold at least where a strategy measures them; what is
                       overridden by hand is among them (`benchbench.run.overrides`)
    authority          share of the range of each input that the planner leaves to the controller, half of it at either end
    hover_ends         first and last input equal hover (authors' public demo; not in the paper)

    A kind has, besides,

    mark  names of fields by which a configuration says that it is of this kind; one of a kind without a mark says
          `kind: NAME` (see `benchbench.ocp.kinds`)
    """

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True)
    mark: ClassVar[tuple[str, ...]] = ()

    name: str
    start: dict[str, Finite]
    end: dict[str, Finite]
    start_velocity: dict[str, Finite] = Field(default_factory=dict)
    travel_time: Range = (0.1, 30.0)
    travel_time_guess: Positive = 3.0
    input_cost: NonNegative = 3e-3
    workspace: dict[str, Range] = Field(default_factory=dict)
    rate_margin: dict[str, Share] = Field(default_factory=dict)
    kept_margins: tuple[str, ...] = ()
    authority: Share = 0.0
    hover_ends: bool = False


class HandoverValues(FlightValues):
    """What a handover has besides.

    order            fixed: stops are made as they are listed; free: in any order
    visit            all: every stop is made; one: exactly one; optional: those with a reward may be left out
    kappa_init       number of consecutive nodes in contact, at least 1 (paper Eq. 26), of a grid of `kappa_grid` intervals
    kappa_grid       the grid whose nodes kappa_init counts: on a finer one a contact has more nodes and lasts as long,
                     (kappa_init - 1) average steps of this one; null: `intervals`
    contact_seconds  duration of the contact in s; null: (kappa_init - 1) average steps. Planned by the phase
                     formulations, asked for by the certificate; progress variables only count nodes
    contact_guess    where in the flight the contact is first guessed, as a fraction of the travel time;
                     several stops are spread evenly before and after this middle
    intervals        N, number of intervals of the time grid
    contact_margin   share of the limits of contacts that the planner leaves unused, by contact name
    aim              share of the limits of contacts within which the planner aims, by contact name; margins come on top
    ball_radius      of the ball that the target stands for, m: the target is its uppermost point
    magnet_reach     clearance in m between ball and end effector at which the magnet takes the ball
    """

    order: Order = "fixed"
    visit: Visit = "all"
    kappa_init: Nodes = 2
    kappa_grid: Intervals | None = None
    contact_seconds: NonNegative | None = None
    contact_guess: Annotated[float, Field(gt=0, lt=1)] = 0.42
    intervals: Intervals = 100
    contact_margin: dict[str, Share] = Field(default_factory=dict)
    aim: dict[str, Aim] = Field(default_factory=dict)
    ball_radius: Positive = 0.03
    magnet_reach: Positive = 0.022


class RaceValues(FlightValues):
    """What a race has besides.

    order           fixed: in the order of the track; free: in any order, which is part of what is to be found
    sequence        numbers of the gates, from 1 as the track lists them, in the order they are passed (where that is
                    free: in which a guess passes them); none: as listed
    gates           number of gates before the end, the lap repeated as often as needed; null: one lap
    radius          of a gate that names none, m
    end_radius      how near to the end the flight may end, m; null: `radius`
    nodes_per_gate  intervals from one gate to the next
    gate_margin     share of a gate's radius that the planner leaves unused
    speed_guess     first guess of the speed in m/s
    """

    mark: ClassVar[tuple[str, ...]] = ("track",)

    order: Order = "fixed"
    sequence: tuple[int, ...] = ()
    gates: Annotated[int, Field(ge=1, le=GATES)] | None = None
    radius: Positive = 0.3
    end_radius: Positive | None = None
    nodes_per_gate: Intervals = 40
    gate_margin: Annotated[NonNegative, Field(lt=1)] = 0.0
    speed_guess: Positive = 5.0
    input_cost: NonNegative = 0.0


class TransferValues(FlightValues):
    """What a transfer has besides.

    intervals  N, number of intervals of the time grid
    """

    intervals: Intervals = 100


OWN: Mapping[str, type[FlightValues]] = {
    "handover": HandoverValues, "race": RaceValues, "transfer": TransferValues,
}  # fmt: skip
"""The core's own kinds by name, the usual one first."""
Kind = TypeVar("Kind", bound=FlightValues)


def marked(values: Mapping[str, Any], kinds: Iterable[type[Kind]]) -> type[Kind] | None:
    """Return the first of some kinds whose mark a configuration has; None where it has none."""
    return next((kind for kind in kinds if any(field in values for field in kind.mark)), None)


def own_kind(values: Mapping[str, Any]) -> type[FlightValues] | None:
    """Return the values of the core's own kind that a configuration means; None where it may mean another one."""
    if (name := values.get(FIELD)) is not None:
        return OWN.get(name)
    others = registry.entries("scenarios")
    return marked(values, OWN.values()) or (None if others else OWN["handover"])
