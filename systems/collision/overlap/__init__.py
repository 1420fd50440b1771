"""Discs that overlap where a run begins."""
