"""What can be said about one node of a trajectory, whatever its transcription."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Node:
    """What can be said about one node: expressions of its local unknowns z and parameters p (SX)."""

    z: ca.SX
    p: ca.SX
    time: ca.SX
    configuration: ca.SX
    velocity: ca.SX
