"""Discs that stay in contact."""
