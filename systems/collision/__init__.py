"""Discs that collide: exact flight between impacts, impacts alone and together, resting contact."""
