"""Statics: equilibria, theories to compare with, and what makes a structure fail."""
