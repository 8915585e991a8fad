"""The video of a stored flight, as the world that it was flown in shows it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from omegaconf import OmegaConf
from pydantic import ValidationError

from benchbench.flight.errand import errand
from benchbench.flight.filmed import HEIGHT, WIDTH, Filmed, Scene
from benchbench.flight.recording import STATE
from benchbench.flight.rig import Rig
from benchbench.flight.world import World
from benchbench.ground.errors import BadInput, Unavailable
from benchbench.ocp.airframe import airframe_of
from benchbench.ocp.motion import sample
from benchbench.run import trust
from benchbench.run.making import made
from benchbench.run.stored import scene_parts
from benchbench.storage.configuration import configuration
from benchbench.storage.files import CONFIG, write_bytes
from benchbench.storage.series import read_series

VIDEO = ".mp4"


def film_flight(recording: Path, output: Path, fps: float) -> Path:
    """Write the video of a run's flight.mcap as MP4, in real time.

    Raises BadInput for what is none, Unavailable with the reason where it cannot be drawn or written.
    """
    if output.suffix.lower() != VIDEO:
        raise BadInput("--output", f"'{output.name}' was given for a flight", f"a file in {VIDEO}")
    world, scene = _scene(recording, fps)
    try:
        from imageio_ffmpeg import write_frames
    except ImportError:
        raise Unavailable(
            "video: imageio-ffmpeg is not installed; pip install 'benchbench[flight]'"
        ) from None
    pictures = world.pictures(scene)
    first = next(pictures)  # what cannot be drawn is told before a file is begun
    made_at = output.with_name(f".{output.stem}.part{VIDEO}")
    try:
        writer = write_frames(str(made_at), (WIDTH, HEIGHT), fps=fps, macro_block_size=16)
        writer.send(None)
        for picture in (first, *pictures):
            writer.send(np.ascontiguousarray(picture))
        writer.close()
        write_bytes(output, made_at.read_bytes())
    except OSError as error:
        raise BadInput("--output", f"'{output}' cannot be written: {error.strerror}") from None
    finally:
        made_at.unlink(missing_ok=True)
    return output


def _scene(recording: Path, fps: float) -> tuple[Filmed, Scene]:
    tree = configuration(recording.parent)
    if tree is None or not tree.get("world") or not tree.get("rig"):
        raise BadInput(
            str(recording.parent), f"has no {CONFIG} of a run that was flown", "the folder of a run"
        )
    scenario, model = scene_parts(tree)
    task, world = errand(scenario), _world(tree)
    states = read_series(recording, "/truth/state", STATE)
    balls = read_series(recording, "/truth/ball", ("x", "y", "z"))
    time = np.arange(states[0, 0], states[-1, 0], 1 / fps)
    near = np.searchsorted(states[:, 0], time).clip(0, len(states) - 1)
    stand = sample(task.target, time)[0] - [0.0, 0.0, task.ball_radius]
    scene = Scene(
        airframe_of(model), _rig(tree), task.ball_radius, task.reach, states[near, 1:], balls[near, 1:], stand
    )
    return world, scene


def _world(tree: dict[str, Any]) -> Filmed:
    """The world of the flight; what is stored is data, so it has to be an installed one."""
    trust.check(tree["world"], "world", ("worlds",))
    world = made(OmegaConf.create({"world": tree["world"]}), "world", World)
    if not isinstance(world, Filmed):
        raise Unavailable(f"video: '{type(world).__name__}' has no pictures of itself; world=mujoco has")
    return world


def _rig(tree: dict[str, Any]) -> Rig:
    try:
        return Rig(**{name: value for name, value in tree["rig"].items() if name != "_target_"})
    except (TypeError, ValidationError) as error:
        raise BadInput(
            "rig", f"cannot be used: {error}", "motor_force, servo_torque, ball_mass, pull"
        ) from None
