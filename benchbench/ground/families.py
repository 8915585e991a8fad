"""What a run chooses: names of groups on the command line, and of columns of the record."""

PLANNED = ("scenario", "vehicle", "dynamics", "relaxation", "solver", "strategy", "guess")
"""For a plan."""
FLOWN = ("world", "controller", "autopilot", "residual", "payload", "predictor", "mismatch", "rig")
"""For its flights."""
