"""Checks of one plugin each, by family; every function raises AssertionError that says what is wrong."""
