"""Loads that change in time."""
