"""MuJoCo's own pictures of a flight, without a display where EGL or OSMesa can draw."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchbench.flight.filmed import HEIGHT, WIDTH, Scene
from benchbench.flight.world import STEP
from benchbench.ground.errors import Unavailable
from benchbench_plugins.worlds.mjcf import Ball, mjcf

REMEDY = "MUJOCO_GL=egl (libegl1, libgl1-mesa-dri) or MUJOCO_GL=osmesa (libosmesa6), or a display"
SKY = '<asset><texture type="skybox" builtin="gradient" rgb1="0.96 0.97 0.99" rgb2="0.74 0.8 0.88" width="64" height="64"/></asset>'
DISTANCE, ASIDE, DOWN = 1.6, 55.0, -18.0
"""m and degrees: where the camera is from what it looks at, the middle of vehicle and ball."""


def pictures(scene: Scene) -> Iterator[NDArray[np.uint8]]:
    """Yield what `Filmed.pictures` asks for."""
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("MUJOCO_GL", "egl")  # read when MuJoCo is imported
    ball = Ball(scene.ball_radius, scene.rig.ball_mass, scene.reach)
    try:
        import mujoco

        text = mjcf(scene.airframe, scene.rig, ball, STEP).replace("<worldbody>", f"{SKY}<worldbody>", 1)
        model = mujoco.MjModel.from_xml_string(text)
        _colour(model)
        data, renderer = mujoco.MjData(model), mujoco.Renderer(model, HEIGHT, WIDTH)
    except Exception as error:  # which of many libraries is missing is told by as many kinds of errors  # noqa: BLE001
        raise Unavailable(
            f"video: MuJoCo cannot draw here ({type(error).__name__}: {error}); {REMEDY}"
        ) from None
    camera = mujoco.MjvCamera()
    camera.distance, camera.azimuth, camera.elevation = DISTANCE, ASIDE, DOWN
    with renderer:
        for state, place, stand in zip(scene.state, scene.ball, scene.stand, strict=True):
            data.qpos[:] = np.concatenate([state[:8], stand, place, [1, 0, 0, 0]])
            mujoco.mj_forward(model, data)
            camera.lookat[:] = (state[:3] + place) / 2
            renderer.update_scene(data, camera)
            yield renderer.render()


def _colour(model: Any) -> None:
    """Lit from the camera, ground light and endless, vehicle blue, ball red, stand grey: what the world computes with has no colour."""
    model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:] = 0.45, 0.55
    model.geom_rgba[:] = [0.35, 0.52, 0.75, 1.0]
    model.geom_rgba[model.geom_bodyid == model.body("stand").id] = [0.5, 0.5, 0.5, 1.0]
    model.geom_size[model.geom("ground").id, :2] = 0.0
    for name, colour in (("ground", [0.75, 0.77, 0.8, 1.0]), ("ball", [0.85, 0.25, 0.2, 1.0])):
        model.geom_rgba[model.geom(name).id] = colour
