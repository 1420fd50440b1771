"""Editing: picking, placing, moving, joining, selecting, and pulling what moves."""
