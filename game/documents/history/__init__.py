"""The past of a session: undo and redo, and the checkpoints of a run to go back to."""
