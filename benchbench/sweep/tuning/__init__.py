"""Search for a better configuration: trials of Optuna over certified plans."""
