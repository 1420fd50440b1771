"""The past of a session: undo and redo, and the moments of a run to go back to."""
