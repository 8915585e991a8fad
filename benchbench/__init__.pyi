# The public face: what users and plugin authors need, and nothing else. Loaded on first use (lazy_loader reads this file).

# interfaces, one class per family of plugins
# values that pass from stage to stage
from .certificate.certificate import Certificate, Check

# what goes wrong, as the program says it
from .errors import BadInput, BenchBenchError, IncompatibleCase, NoPlan, Unavailable
from .mpcc.problem import Block, Mpcc, Pair, PairKind, Slot, Variable, evaluate, rows
from .mpcc.ready import ReadyMade, whole
from .nlp.relaxation import Relaxation, Relaxed, Schedule, Shared, Unknown
from .nlp.solver import (
    TOLERANCE,
    Accuracy,
    Claim,
    Outcome,
    Parametric,
    Point,
    Prepared,
    Progress,
    Setup,
    Solver,
)
from .ocp.contact import Condition, Contact, Target
from .ocp.model import Coordinates, Model, Plant
from .ocp.motion import Motion
from .ocp.plan import Array, Plan
from .ocp.scenario import Scenario
from .planning.case import Case, Ledger, ReadyCase, Task
from .planning.guess import Guess
from .planning.peer import Peer
from .planning.strategy import Result, Strategy
from .transcription.dynamics import Dynamics, Grid, Node, Phase, Trajectory

__version__: str

__all__ = [
    "TOLERANCE", "Accuracy", "Array", "BadInput", "BenchBenchError", "Block", "Case", "Certificate", "Check", "Claim",
    "Condition", "Contact", "Coordinates", "Dynamics", "Grid", "Guess", "IncompatibleCase", "Ledger", "Model", "Motion",
    "Mpcc", "NoPlan", "Node", "Outcome", "Pair", "PairKind", "Parametric", "Peer", "Phase", "Plan", "Plant", "Point",
    "Prepared", "Progress", "ReadyCase", "ReadyMade", "Relaxation", "Relaxed", "Result", "Scenario", "Schedule", "Setup",
    "Shared", "Slot", "Solver", "Strategy", "Target", "Task", "Trajectory", "Unavailable", "Unknown", "Variable",
    "evaluate", "rows", "whole",
]  # fmt: skip
