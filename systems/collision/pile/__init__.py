"""Crowds of discs in lasting contact."""
