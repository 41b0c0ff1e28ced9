"""Marker sets: taken from other programs' files, checked against a capture, changed by hand."""
