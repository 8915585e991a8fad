"""Races: ordered gates, passed in least time."""
