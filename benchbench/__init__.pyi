# The public face: what users and plugin authors need, and nothing else. Loaded on first use (lazy_loader reads this file).

from .certificate.certificate import Certificate
from .certificate.check import Check, at_least, at_most, worst
from .certificate.evidence import Evidence
from .ground.arrays import Array
from .ground.errors import BadInput, BenchBenchError, IncompatibleCase, NoPlan, Unavailable
from .mpcc.problem import Block, Mpcc, Pair, PairKind, Slot, Variable, block, evaluate, rows
from .mpcc.ready import ReadyMade, whole
from .nlp.ledger import Ledger
from .nlp.method import Method
from .nlp.relaxation import Gap, Relaxation, Relaxed, Schedule, Shared, Unknown
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
from .ocp.contact import Condition, Contact, Standing, Target
from .ocp.cost import Cost
from .ocp.handover import Handover
from .ocp.mechanics import acceleration
from .ocp.model import (
    Coordinates,
    ExplicitModel,
    LagrangianModel,
    ManifoldModel,
    Model,
    OutputModel,
    Plant,
    RacingModel,
    RampModel,
    space,
)
from .ocp.motion import Motion
from .ocp.node import Node
from .ocp.plan import Plan
from .ocp.race import Race
from .ocp.scenario import Scenario
from .ocp.space import Space
from .ocp.touching import TouchingModel
from .ocp.transfer import Transfer
from .planning.case import Case, Guess, MpccStrategy, ReadyCase, Strategy
from .planning.peer import Peer
from .planning.result import Result, Solution
from .run.verbs import certify, load, plan, runs
from .run.view import RunView
from .transcription.dynamics import Dynamics
from .transcription.grid import Grid, Phase, Trajectory

__version__: str

__all__ = [
    "TOLERANCE", "Accuracy", "Array", "BadInput", "BenchBenchError", "Block", "Case", "Certificate", "Check",
    "Claim", "Condition", "Contact", "Coordinates", "Cost", "Dynamics", "Evidence", "ExplicitModel", "Gap", "Grid",
    "Guess", "Handover", "IncompatibleCase", "LagrangianModel", "Ledger", "ManifoldModel", "Method", "Model",
    "Motion", "Mpcc", "MpccStrategy", "NoPlan", "Node", "Outcome", "OutputModel", "Pair", "PairKind", "Parametric",
    "Peer", "Phase", "Plan", "Plant", "Point", "Prepared", "Progress", "Race", "RacingModel", "RampModel",
    "ReadyCase", "ReadyMade", "Relaxation", "Relaxed", "Result", "RunView", "Scenario", "Schedule", "Setup",
    "Shared", "Slot", "Solution", "Solver", "Space", "Standing", "Strategy", "Target", "TouchingModel", "Trajectory", "Transfer", "Unavailable", "Unknown",
    "Variable", "acceleration", "at_least", "at_most", "block", "certify", "evaluate", "load", "plan", "rows",
    "runs", "space", "whole", "worst",
]  # fmt: skip
