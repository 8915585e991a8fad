"""The plan flown in closed loop against a world that no planner has written, many times, under declared mismatch."""
