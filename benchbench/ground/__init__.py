"""The ground that all rooms stand on: arrays, errors, the registry of plugins."""
