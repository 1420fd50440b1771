"""What an impact does."""
