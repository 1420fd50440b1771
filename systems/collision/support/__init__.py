"""Forces between particles that rest on one another while other forces drive them."""
