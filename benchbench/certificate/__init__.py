"""Judges a plan without trusting whoever made it."""
