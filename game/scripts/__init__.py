"""Scripted sessions: written, recorded, replayed, watched."""
