"""The layout, and what is laid out by it."""
