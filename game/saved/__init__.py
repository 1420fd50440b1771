"""What a person keeps between sessions: models, unsaved work, preferences."""
