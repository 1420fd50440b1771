"""Flight from impact to impact."""
