"""What is foreseen, and for how long."""
