"""Documents: models and their files, what is open, the undo log, and what is kept between sessions."""
