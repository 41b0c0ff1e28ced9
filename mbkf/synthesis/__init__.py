"""Synthetic captures with exact truth: motions that obey Newton's law, and their measurement."""
