"""What a viewer draws of a plan: frames, paths and the vehicle itself, in Foxglove's protobuf schemas."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np
from foxglove import Context
from foxglove.channels import FrameTransformsChannel, PosesInFrameChannel, SceneUpdateChannel
from foxglove.messages import (
    Color,
    CubePrimitive,
    FrameTransform,
    FrameTransforms,
    LinePrimitive,
    LinePrimitiveLineType,
    Point3,
    Pose,
    PosesInFrame,
    Quaternion,
    SceneEntity,
    SceneUpdate,
    SpherePrimitive,
    Timestamp,
    Vector3,
)

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Standing
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.touching import TouchingModel
from benchbench.storage.entry import LogEntry, nanoseconds
from benchbench.storage.multirotor import vehicle_pose

if TYPE_CHECKING:
    from benchbench.ocp.model import Model

WORLD = "world"
BLUE, GREEN = Color(r=0.0, g=0.35, b=0.70, a=1.0), Color(r=0.0, g=0.55, b=0.35, a=1.0)
PINK, OLIVE = Color(r=0.80, g=0.40, b=0.65, a=1.0), Color(r=0.50, g=0.50, b=0.0, a=1.0)
GREY = Color(r=0.33, g=0.33, b=0.33, a=1.0)
LINE_M, SPHERE_M, CUBE_M = 0.006, 0.02, 0.04
"""Sizes of what is drawn, in m."""

Paths = Mapping[str, tuple[Array, Array]]
"""Positions (n, 3) m and unit quaternions (n, 4) as x, y, z, w of each frame, by name."""


def scene(context: Context, plan: Plan, scenario: Scenario, model: Model) -> Iterator[LogEntry]:
    """Messages on /tf, /path/... and /scene, at the nodes of the plan."""
    paths = _paths(plan, scenario, model)
    log_times = nanoseconds(plan.time)
    frames = FrameTransformsChannel("/tf", context=context)
    view = SceneUpdateChannel("/scene", context=context)
    for name, (position, quaternion) in paths.items():
        poses = [_pose(p, q) for p, q in zip(position, quaternion, strict=True)]
        channel = PosesInFrameChannel(f"/path/{name}", context=context)
        yield LogEntry(0, channel, PosesInFrame(timestamp=_stamp(0), frame_id=WORLD, poses=poses))
    yield LogEntry(
        0,
        view,
        SceneUpdate(entities=[_path_lines(paths), *furniture(scenario), *_obstacles(scenario, model)]),
    )
    for k, log_time in enumerate(log_times):
        yield LogEntry(log_time, frames, FrameTransforms(transforms=_transforms(paths, k, log_time)))
        body = _body(model.plant().skeleton(plan.configuration[k]), log_time)
        yield LogEntry(log_time, view, SceneUpdate(entities=[body, _points(paths, k, log_time)]))


@singledispatch
def furniture(scenario: Scenario) -> list[SceneEntity]:
    """What stands in the room all the time, by kind of scenario; nothing, if it does not say."""
    return []


def _obstacles(scenario: Scenario, model: Model) -> list[SceneEntity]:
    """Outlines of what stands in the way, and of what the vehicle touches, parted where they have rows of NaN."""
    standing = [one for one in scenario.obstacles.values() if isinstance(one, Standing)]
    outlines = [line for one in standing for line in one.outlines().values()]
    outlines += model.surroundings.values() if isinstance(model, TouchingModel) else ()
    lines = [
        _line(part[~np.isnan(part[:, 0])], GREY)
        for outline in outlines
        for part in np.split(outline, np.flatnonzero(np.isnan(outline[:, 0])))
    ]
    return [SceneEntity(timestamp=_stamp(0), frame_id=WORLD, id="obstacles", lines=lines)] if lines else []


def _paths(plan: Plan, scenario: Scenario, model: Model) -> Paths:
    upright = np.tile([0.0, 0.0, 0.0, 1.0], (len(plan.time), 1))
    return {
        "vehicle": vehicle_pose(plan.coordinate_names, plan.configuration),
        "end_effector": (model.plant().tool(plan.configuration, plan.velocity)[0], upright),
        **{
            stop.named("target"): (sample(stop.target, plan.time)[0], upright)
            for stop in scenario.itinerary.stops
        },
    }


def _transforms(paths: Paths, k: int, log_time: int) -> list[FrameTransform]:
    return [
        FrameTransform(
            timestamp=_stamp(log_time),
            parent_frame_id=WORLD,
            child_frame_id=name,
            translation=_vector(position[k]),
            rotation=_rotation(quaternion[k]),
        )
        for name, (position, quaternion) in paths.items()
    ]


def _path_lines(paths: Paths) -> SceneEntity:
    colors = {"vehicle": BLUE, "end_effector": PINK}
    lines = [_line(position, colors.get(name, OLIVE)) for name, (position, _) in paths.items()]
    return SceneEntity(timestamp=_stamp(0), frame_id=WORLD, id="paths", lines=lines)


def _body(skeleton: Mapping[str, Array], log_time: int) -> SceneEntity:
    lines = [_line(points, GREEN if "arm" in name else BLUE) for name, points in skeleton.items()]
    return SceneEntity(timestamp=_stamp(log_time), frame_id=WORLD, id="vehicle", lines=lines)


def _points(paths: Paths, k: int, log_time: int) -> SceneEntity:
    poses = {name: _pose(*(part[k] for part in path)) for name, path in paths.items()}
    targets = [pose for name, pose in poses.items() if name.startswith("target")]
    return SceneEntity(
        timestamp=_stamp(log_time),
        frame_id=WORLD,
        id="contact",
        spheres=[SpherePrimitive(pose=poses["end_effector"], size=_vector([SPHERE_M] * 3), color=PINK)],
        cubes=[CubePrimitive(pose=pose, size=_vector([CUBE_M] * 3), color=OLIVE) for pose in targets],
    )


@furniture.register
def _(race: Race) -> list[SceneEntity]:
    """Balls and rectangles."""
    clear = Color(r=0.50, g=0.50, b=0.0, a=0.4)
    balls = [
        SpherePrimitive(
            pose=_pose(np.array(gate.position), np.array([0.0, 0.0, 0.0, 1.0])),
            size=_vector([2 * gate.radius] * 3),
            color=clear,
        )
        for gate in race.goals
        if gate.opening is None
    ]
    frames = [
        _line(np.array([*gate.corners, gate.corners[0]]), OLIVE)
        for gate in race.goals
        if gate.opening is not None
    ]
    return [SceneEntity(timestamp=_stamp(0), frame_id=WORLD, id="gates", spheres=balls, lines=frames)]


def _line(points: Array, color: Color) -> LinePrimitive:
    vertices = [Point3(x=float(x), y=float(y), z=float(z)) for x, y, z in points]
    return LinePrimitive(type=LinePrimitiveLineType.LineStrip, thickness=LINE_M, points=vertices, color=color)


def _pose(position: Array, quaternion: Array) -> Pose:
    return Pose(position=_vector(position), orientation=_rotation(quaternion))


def _vector(values: Array | list[float]) -> Vector3:
    x, y, z = map(float, values)
    return Vector3(x=x, y=y, z=z)


def _rotation(quaternion: Array) -> Quaternion:
    x, y, z, w = map(float, quaternion)
    return Quaternion(x=x, y=y, z=z, w=w)


def _stamp(log_time: int) -> Timestamp:
    return Timestamp(sec=log_time // 10**9, nsec=log_time % 10**9)
