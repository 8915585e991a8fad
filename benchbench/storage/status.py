"""How a run can end: one typed outcome per run, each with a meaning and a remedy."""

from __future__ import annotations

from enum import StrEnum
from typing import Self


class Status(StrEnum):
    """Typed outcome of a run; `message` says what happened, `remedy` what to do about it."""

    message: str
    remedy: str

    def __new__(cls, value: str, message: str, remedy: str) -> Self:
        """Make a member that is its own text in records."""
        member = str.__new__(cls, value)
        member._value_ = value
        member.message, member.remedy = message, remedy
        return member

    CERTIFIED = (
        "certified",
        "the plan passed every check of the certificate",
        "nothing to do",
    )
    UNCERTIFIED = (
        "uncertified",
        "the solver returned a plan, but the certificate rejects it",
        "see `reasons`; more intervals, a better guess or a more accurate dynamics usually helps",
    )
    INFEASIBLE = (
        "infeasible",
        "the solver stopped at a point that violates the constraints and saw no way on",
        "try another guess, relaxation or strategy, or loosen the scenario",
    )
    ITERATION_LIMIT = (
        "iteration_limit",
        "the solver used up its iterations",
        "raise the iteration limit of the solver, or start from a better guess",
    )
    TIME_LIMIT = (
        "time_limit",
        "the solver stopped by itself at its time budget",
        "raise the time budget, or reduce the number of intervals",
    )
    TIMEOUT = (
        "timeout",
        "the run did not end within its wall-clock limit and was killed",
        "raise the wall-clock limit; a solver that ignores its own time budget ends here",
    )
    CRASH = (
        "crash",
        "the process of the run died; `reasons` names the signal or exit code",
        "check the installation of the solver (a linear solver that is not installed is the usual cause)",
    )
    OUT_OF_MEMORY = (
        "out_of_memory",
        "the run needed more memory than its limit",
        "raise the memory limit, or reduce the number of intervals or of parallel runs",
    )
    PRUNED = (
        "pruned",
        "a study gave the run up between two solves, because its trial could not become the best any more",
        "nothing to do; hydra.sweeper.prune=false lets such runs end",
    )
    UNAVAILABLE = (
        "unavailable",
        "a chosen backend is not installed here or has no licence",
        "install what `reasons` names, or choose another backend",
    )
    INCOMPATIBLE = (
        "incompatible",
        "two choices of this run cannot work together",
        "change one of the two choices that `reasons` names",
    )
    BAD_INPUT = (
        "bad_input",
        "the configuration asks for something that does not exist or cannot be",
        "change the field that `reasons` names",
    )
    ERROR = (
        "error",
        "the run stopped with an error, its own or the solver's",
        "read `reasons`; where a solver gave up, try another guess, accuracy or option of it; where neither it nor a "
        "wrong input is named, please report a bug",
    )
