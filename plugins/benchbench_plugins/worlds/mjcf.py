"""The vehicle, the ball on its stand and the ground as a MuJoCo model, made of the airframe's numbers.

Bits of contact: 1 ball and cup, 2 ball and magnet, 4 vehicle and obstacles, 8 ball and vehicle or ground. Only the magnet's own
geometry pulls, and only on the ball. A geometry's `gap` makes a contact without force at a distance, on which `adhesion`
acts; `margin` stays 0, since it would let contact forces push at that distance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.flight.rig import Rig
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe


@dataclass(frozen=True)
class Ball:
    """radius m, mass kg, reach of the magnet m."""

    radius: float
    mass: float
    reach: float


TIP = 0.002
"""m, radius of the magnet's face about the end effector."""
LINK = 0.02
"""m, so far before its tip the arm's own shape ends."""
STAND = 1000.0
"""kg, so that nothing moves it."""
CUP = 8
"""Small spheres that the ball lies on."""


def mjcf(airframe: Airframe, rig: Rig, ball: Ball, step: float) -> str:
    """Return the model as XML; masses and inertias of the vehicle are placeholders, which the world replaces."""
    a, lower = airframe, ball.radius
    motors = "".join(f'<site name="m{i}" pos="{_text(place)}"/>' for i, place in enumerate(a.rotors))
    gears = "".join(f'<general site="m{i}" gear="0 0 1 0 0 {drag:.17g}"/>' for i, drag in enumerate(a.drag))
    arms = "".join(
        f'<geom type="capsule" size=".012" fromto="0 0 0 {_text(place)}" contype="4" conaffinity="8"/>'
        for place in a.rotors
    )
    return f"""
<mujoco><option timestep="{step}" gravity="0 0 {-a.gravity}" integrator="implicitfast"/>
<compiler angle="radian" balanceinertia="false" inertiafromgeom="false"/>
<default><geom density="0"/></default>
<worldbody><light pos="0 0 3"/>
<geom name="ground" type="plane" size="5 5 .1" contype="0" conaffinity="12"/>
<body name="vehicle"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>{motors}{arms}
 <body name="arm" pos="0 0 {-a.arm_offset}"><joint name="arm" type="hinge" axis="0 1 0"/>
  <inertial pos="{a.arm_length / 2} 0 0" mass="1" diaginertia="1 1 1"/>
  <geom type="capsule" size=".006" fromto="0 0 0 {a.arm_length - LINK} 0 0" contype="4" conaffinity="0"/>
  <body name="magnet" pos="{a.arm_length} 0 0">
   <geom name="magnet" type="sphere" size="{TIP}" contype="0" conaffinity="2" gap="{ball.reach - TIP}"
    condim="6" friction="1 .02 .01" priority="1"/></body></body></body>
<body name="stand" gravcomp="1"><inertial pos="0 0 0" mass="{STAND}" diaginertia="1 1 1"/>
 <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/>
 {_cup(lower)}
 <geom type="cylinder" size=".015 .1" pos="0 0 {-lower - 0.12}" contype="0" conaffinity="4"/></body>
<body name="ball"><freejoint/><inertial pos="0 0 0" mass="{ball.mass}"
 diaginertia="{_text(np.full(3, 0.4 * ball.mass * lower**2))}"/>
 <geom name="ball" type="sphere" size="{lower}" contype="11" conaffinity="0"/></body>
</worldbody>
<actuator>{gears}<general joint="arm"/><adhesion body="magnet" ctrlrange="0 1" gain="{rig.pull}"/></actuator>
</mujoco>"""


def _cup(radius: float) -> str:
    """Small spheres around the ball's lower part, which it rests on, centred at the ball's centre."""
    small, out = radius / 6, np.radians(35)
    away = (radius + small) * np.array([np.sin(out), -np.cos(out)])
    around = 2 * np.pi * np.arange(CUP) / CUP
    places = [np.array([away[0] * np.cos(b), away[0] * np.sin(b), away[1]]) for b in around]
    return "".join(
        f'<geom type="sphere" size="{small}" pos="{_text(place)}" contype="0" conaffinity="1"/>'
        for place in places
    )


def _text(numbers: Array) -> str:
    return " ".join(f"{number:.17g}" for number in numbers)
