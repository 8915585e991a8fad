"""Built-in autopilots."""
