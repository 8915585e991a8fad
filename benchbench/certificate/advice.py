"""What to change so that a rejected plan may be certified; a check names what helps where it is broken."""

from __future__ import annotations

FINER = "raise scenario.intervals (races: scenario.nodes_per_gate), or take dynamics=collocation"
RATE = f"{FINER}; with strategy=relax raise scenario.rate_margin of that coordinate"
CONTACT = f"{FINER}; with strategy=relax raise scenario.contact_margin of that contact"
GATE = f"{FINER}; raise scenario.gate_margin"
RESTART = "start from another guess, or take another solver"
SOLVE = "raise iteration_limit, time_limit or accuracy, or start from another guess"
ACCURACY = "raise accuracy, iteration_limit or time_limit"
PATH = "raise accuracy or iteration_limit"
SHARPEN = "end relaxation.schedule with a smaller sigma, or take another relaxation"
SHARPEN_OR_GUESS = "end relaxation.schedule with a smaller sigma, or start from another guess"
PHASES_OR_SHARPEN = "take guess=phases or strategy=phases, or end relaxation.schedule with a smaller sigma"
PHASES_OR_RELAXATION = "take guess=phases or strategy=phases, or another relaxation"
SECONDS = "take strategy=phases, which holds the contact for scenario.contact_seconds"
