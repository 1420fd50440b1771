"""Discs that other forces drive: where their paths in one step first meet, and what an impact does to them."""
