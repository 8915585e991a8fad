"""What to change so that a rejected plan may be certified: one sentence for each kind of broken limit."""

from __future__ import annotations

from collections.abc import Iterable

FINER = "raise scenario.intervals (races: scenario.nodes_per_gate), or take dynamics=collocation"
ADVICE = (
    ("finite", "start from another guess, or take another solver"),
    ("time", "start from another guess, or take another solver"),
    ("residual", "raise iteration_limit, time_limit or accuracy, or start from another guess"),
    ("complementarity", "end relaxation.schedule with a smaller sigma, or take another relaxation"),
    ("planned", "raise accuracy, iteration_limit or time_limit"),
    ("defect", FINER),
    ("replay_rate", f"{FINER}; with strategy=relax raise scenario.rate_margin of that coordinate"),
    ("replay", FINER),
    ("contact_node", "end relaxation.schedule with a smaller sigma, or start from another guess"),
    (
        "contact_steps",
        "take guess=phases or strategy=phases, or end relaxation.schedule with a smaller sigma",
    ),
    ("contact_progress", "take guess=phases or strategy=phases, or another relaxation"),
    ("contact_seconds", "take strategy=phases, which holds the contact for scenario.contact_seconds"),
    ("contact", f"{FINER}; with strategy=relax raise scenario.contact_margin of that contact"),
    ("segment", FINER),
    ("gate", f"{FINER}; raise scenario.gate_margin"),
    ("path", "raise accuracy or iteration_limit"),
)
"""Beginning of a check's name and what helps; the first that fits counts."""


def advice(broken: Iterable[str]) -> str:
    """Return what to change, given the names of broken checks; "" without any.

    Only the first kind is answered: a plan that does not solve its problem need not be refined.
    """
    for name in broken:
        for start, text in ADVICE:
            if name.startswith(start):
                return text
    return ""
