"""A flight as ROS 2 messages in an MCAP file, without an installation of ROS: for `ros2 bag play` and trackers.

Body: trajectory_msgs/msg/MultiDOFJointTrajectory, linear and angular velocity in the world frame, as the header's
frame says. Arm: trajectory_msgs/msg/JointTrajectory with angle, rate and effort. Neither has a place for motor
thrusts; the CSV, which is attached, has them.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchbench.ground.arrays import Array
from benchbench.ground.errors import Unavailable
from benchbench.storage.attached import KIND, NAME
from benchbench.storage.entry import nanoseconds
from benchbench.storage.flight_csv import to_csv
from benchbench.storage.multirotor import MultirotorTrajectory

WORLD, BODY, ARM = "world", "base_link", "arm"
BODY_TOPIC, ARM_TOPIC = "/body_trajectory", "/arm_trajectory"
MESSAGES = "trajectory_msgs/msg/"


def to_mcap(flight: MultirotorTrajectory, metadata: Mapping[str, str]) -> bytes:
    """Return an MCAP file of profile ros2 with one message for the body and one for the arm, if there is one.

    `metadata` becomes the metadata record "benchbench". Raises Unavailable where rosbags or mcap is missing.
    """
    try:
        from mcap.writer import Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise Unavailable(f"ROS 2: {error.name} is not installed; pip install 'benchbench[ros2]'") from None
    store = get_typestore(Stores.ROS2_JAZZY)
    out = io.BytesIO()
    writer = Writer(out)
    writer.start(profile="ros2", library="benchbench")
    for topic, message in _messages(store.types, flight).items():
        name = message.__msgtype__
        text, _ = store.generate_msgdef(name, ros_version=2)
        schema = writer.register_schema(name, "ros2msg", text.encode())
        channel = writer.register_channel(topic, "cdr", schema)
        writer.add_message(channel, 0, bytes(store.serialize_cdr(message, name)), 0)
    writer.add_metadata("benchbench", dict(metadata))
    writer.add_attachment(0, 0, NAME, KIND, to_csv(flight).encode())
    writer.finish()  # type: ignore[no-untyped-call]
    return out.getvalue()


def _messages(types: Mapping[str, Any], flight: MultirotorTrajectory) -> dict[str, Any]:
    """The messages by topic; `types` are the classes of ROS 2's messages by name."""
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), WORLD)
    since = [
        types["builtin_interfaces/msg/Duration"](*divmod(ns, 10**9))
        for ns in nanoseconds(flight.time - flight.time[0])
    ]
    points = [_body_point(types, flight, k, since[k]) for k in range(len(since))]
    found = {BODY_TOPIC: types[MESSAGES + "MultiDOFJointTrajectory"](header, [BODY], points)}
    if flight.arm is not None:
        point = types[MESSAGES + "JointTrajectoryPoint"]
        rows = [
            point(np.array([angle]), np.array([rate]), np.zeros(0), np.array([effort]), time)
            for (angle, rate, effort), time in zip(flight.arm, since, strict=True)
        ]
        found[ARM_TOPIC] = types[MESSAGES + "JointTrajectory"](header, [ARM], rows)
    return found


def _body_point(types: Mapping[str, Any], flight: MultirotorTrajectory, k: int, time: Any) -> Any:
    def vector(values: Array) -> Any:
        return types["geometry_msgs/msg/Vector3"](*map(float, values))

    w, x, y, z = map(float, flight.quaternion[k])
    turn = types["geometry_msgs/msg/Quaternion"](x, y, z, w)
    spin = Rotation.from_quat([x, y, z, w]).apply(flight.body_rates[k])
    place = types["geometry_msgs/msg/Transform"](vector(flight.position[k]), turn)
    twist = types["geometry_msgs/msg/Twist"](vector(flight.velocity[k]), vector(spin))
    return types[MESSAGES + "MultiDOFJointTrajectoryPoint"]([place], [twist], [], time)
