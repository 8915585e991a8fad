"""Built-in motions of targets."""

from benchbench_plugins.motions.braking import Braking
from benchbench_plugins.motions.circle import Circle
from benchbench_plugins.motions.combined import Combined
from benchbench_plugins.motions.fixed import Fixed
from benchbench_plugins.motions.linear import Linear
from benchbench_plugins.motions.spline import Spline

__all__ = ["Braking", "Circle", "Combined", "Fixed", "Linear", "Spline"]
