"""Collisions of free particles: exact flight from impact to impact, and piles."""
