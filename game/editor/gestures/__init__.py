"""Gestures: what a person draws and drags with the pointer."""
