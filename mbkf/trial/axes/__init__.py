"""Axes of a capture against the person in it: evidence, decision, and the corrected capture."""
