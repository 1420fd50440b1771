"""Pictures of a model: composed as plain data, then drawn by a backend."""
