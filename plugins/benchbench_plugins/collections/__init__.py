"""Built-in readers of problem collections."""
