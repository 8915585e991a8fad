# The public face: what users and plugin authors need, and nothing else. Loaded on first use (lazy_loader reads this file).

# interfaces, one class per family of plugins
# values that pass from stage to stage
from .case import Case, Ledger, ReadyCase, Task
from .certificate.certificate import Certificate, Check
from .contact import Condition, Contact, Target
from .dynamics import Dynamics, Grid, Node, Phase, Trajectory

# what goes wrong, as the program says it
from .errors import BadInput, BenchBenchError, IncompatibleCase, NoPlan, Unavailable
from .guess import Guess
from .model import Coordinates, Model, Plant
from .motion import Motion
from .mpcc import Block, Mpcc, Pair, PairKind, Slot, Variable, evaluate, rows
from .peer import Peer
from .plan import Array, Plan
from .ready import ReadyMade, whole
from .relaxation import Relaxation, Relaxed, Schedule, Shared, Unknown
from .scenario import Scenario
from .solver import TOLERANCE, Accuracy, Claim, Outcome, Parametric, Point, Prepared, Progress, Setup, Solver
from .strategy import Result, Strategy

__version__: str

__all__ = [
    "TOLERANCE", "Accuracy", "Array", "BadInput", "BenchBenchError", "Block", "Case", "Certificate", "Check", "Claim",
    "Condition", "Contact", "Coordinates", "Dynamics", "Grid", "Guess", "IncompatibleCase", "Ledger", "Model", "Motion",
    "Mpcc", "NoPlan", "Node", "Outcome", "Pair", "PairKind", "Parametric", "Peer", "Phase", "Plan", "Plant", "Point",
    "Prepared", "Progress", "ReadyCase", "ReadyMade", "Relaxation", "Relaxed", "Result", "Scenario", "Schedule", "Setup",
    "Shared", "Slot", "Solver", "Strategy", "Target", "Task", "Trajectory", "Unavailable", "Unknown", "Variable",
    "evaluate", "rows", "whole",
]  # fmt: skip
