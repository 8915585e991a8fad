"""How far the aerial manipulator can come from a standstill, proved from its motors and inertia without any solve.

Let H be the angular momentum of body and arm about their common centre of mass, omega the body's rates, b the thrust axis,
f the thrust over the whole mass, mu the arm's share of the mass, c its centre of mass from the body's. From rest,

    |H(t)|     <= integral of |M|,  M the moment of rotors about the common centre: |M| <= hypot(2 l D + F mu |c_x|, 2 c_tau D),
                  D the room of one motor, F the largest thrust, l the lever; H is taken in the world, so no gyroscopic term counts
    |omega|    <= |J^-1| |H| + |J^-1 e_y| h,  the largest over all arm angles; h the arm's own momentum at its largest rate
    tilt(t)    <= tilt(0) + integral of min(|omega|, hypot of the limits of roll and pitch rate), and the limit of roll and pitch
    |a_xy|     <= f sin(tilt),  f cos(tilt) - g <= a_z <= f - g   of the common centre of mass

and the vehicle's position is mu R c away from that centre, which turns by no more than omega does. Positions found from this
are cut where the speed limit is. In reversed time all of it holds as well: so far can the vehicle be away that comes to rest.
What the relaxation gives away: the direction of every bound is free at every instant, the thrust is largest while the moments are.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from benchbench.ground.arrays import Array
from benchbench_plugins.models.aerial_manipulator_parameters import Parameters

STEP, UNTIL = 1e-3, 1.5
"""s; later than that only the speed limit counts, which bounds less."""
ANGLES = 181
"""Arm angles at which inertias are looked at; the largest is taken 0.1 % larger, far more than lies between them."""
SPARE = 1.001


def way(p: Parameters, arm: float, tilt: float, time: Array) -> tuple[Array, Array]:
    """Return metres back and ahead along x, y, z, each (n, 3), that the position can be away after `time` (n,) s from rest.

    arm, tilt: the arm's angle and the tilt of the thrust axis at rest, rad.
    """
    back, ahead = _lost(p, arm, tilt)
    at = np.clip((np.asarray(time) / STEP).astype(int), 0, len(back) - 1)
    fast = np.array(p.speed) * np.maximum(time, 0.0)[:, None]
    return fast - back[at], fast - ahead[at]


def yaw_acceleration(p: Parameters) -> float:
    """Return the largest angular acceleration in rad/s^2 that the yaw torque alone gives to the level vehicle.

    The yaw torque is that of two motors at either limit, against the inertia with the arm where it is least.
    """
    torque = 2 * p.torque_coefficient * (p.motor_force[1] - p.motor_force[0])
    return torque / float(np.min(_inertia(p, np.linspace(*p.arm_angle, ANGLES))[:, 2, 2]))


@lru_cache(8)
def _lost(p: Parameters, arm: float, tilt: float) -> tuple[Array, Array]:
    """What a flight from rest is behind one at the largest speed, back and ahead, each (steps, 3) m, at least.

    Free until any instant and at the largest speed from there on, whatever is least.
    """
    steps = np.arange(0.0, UNTIL, STEP)
    turned, lean = _turned(p, arm, tilt, steps)
    mass, share = p.quadrotor_mass + p.arm_mass, p.arm_mass / (p.quadrotor_mass + p.arm_mass)
    most, least = 4 * p.motor_force[1] / mass, 4 * p.motor_force[0] / mass
    aside = _twice(most * np.sin(lean))
    up = _twice(np.full(len(steps), max(most - p.gravity, 0.0)))
    down = _twice(np.maximum(p.gravity - least * np.cos(lean), 0.0))
    far = p.arm_offset + p.arm_length / 2
    swung = p.arm_length / 2 * np.minimum(p.arm_rate * steps, p.arm_angle[1] - p.arm_angle[0])
    off = share * np.minimum(swung + far * np.minimum(turned, 2.0), 2 * far)
    fast = np.outer(steps, p.speed)
    ways = (np.stack([aside, aside, z], axis=1) + off[:, None] for z in (down, up))
    back, ahead = (np.maximum.accumulate(np.maximum(fast - free, 0.0)) for free in ways)
    return back, ahead


def _turned(p: Parameters, arm: float, tilt: float, time: Array) -> tuple[Array, Array]:
    """Angle turned since rest and tilt of the thrust axis, both (n,) rad, at most."""
    room, mass = p.motor_force[1] - p.motor_force[0], p.quadrotor_mass + p.arm_mass
    angles = np.linspace(*p.arm_angle, ANGLES)
    largest = float(np.max(np.abs(np.cos(p.arm_angle)))) * p.arm_length / 2
    aside = np.minimum(p.arm_length / 2 * (abs(np.cos(arm)) + p.arm_rate * time), largest)
    lever = np.sqrt(2) / 4 * p.frame
    thrown = 4 * p.motor_force[1] * p.arm_mass / mass * aside
    moment = np.hypot(2 * lever * room + thrown, 2 * p.torque_coefficient * room)
    inverse = np.linalg.inv(_inertia(p, angles))
    own = _arm_momentum(p, angles) * p.arm_rate
    light = SPARE * float(np.max(np.linalg.norm(inverse, 2, axis=(1, 2))))
    kick = SPARE * float(np.max(np.linalg.norm(inverse[:, :, 1], axis=1))) * own
    rate = light * _once(moment) + kick
    limit = np.hypot(*p.angular_rate[:2])
    steepest = np.arccos(np.cos(min(p.tilt, np.pi / 2)) ** 2)
    return _once(rate), np.minimum(tilt + _once(np.minimum(rate, limit)), max(steepest, tilt))


def _inertia(p: Parameters, arm: Array) -> Array:
    """Inertia of body and arm about their common centre of mass in the body frame, (n, 3, 3) kg m^2, for arm angles (n,)."""
    c, s, o = np.cos(arm), np.sin(arm), np.zeros(len(arm))
    frame = np.stack([np.stack(row, axis=-1) for row in ((c, o, s), (o, o + 1, o), (-s, o, c))], axis=1)
    centre = _centre(p, arm)
    outer = centre[:, :, None] * centre[:, None, :]
    steiner = _reduced(p) * (np.sum(centre**2, axis=1)[:, None, None] * np.eye(3) - outer)
    own = frame @ np.diag(p.arm_inertia) @ np.swapaxes(frame, 1, 2)
    return np.asarray(np.diag(p.quadrotor_inertia) + own + steiner)


def _arm_momentum(p: Parameters, arm: Array) -> float:
    """Angular momentum per arm rate of the arm's own motion about the common centre, at most, kg m^2."""
    farthest = float(np.max(np.linalg.norm(_centre(p, arm), axis=1)))
    return p.arm_inertia[1] + _reduced(p) * farthest * p.arm_length / 2


def _centre(p: Parameters, arm: Array) -> Array:
    """The arm's centre of mass from the body's, (n, 3) m."""
    half = p.arm_length / 2
    return np.stack([half * np.cos(arm), 0 * arm, -p.arm_offset - half * np.sin(arm)], axis=1)


def _reduced(p: Parameters) -> float:
    return p.quadrotor_mass * p.arm_mass / (p.quadrotor_mass + p.arm_mass)


def _once(rate: Array) -> Array:
    """Integral of a rate that does not fall, from above: each cell at its end."""
    return np.concatenate([[0.0], np.cumsum(np.maximum.accumulate(rate)[1:])]) * STEP


def _twice(acceleration: Array) -> Array:
    return _once(_once(acceleration))
