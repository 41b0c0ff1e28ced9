"""Marker protocols: chosen or inferred for a capture, imported from other programs, checked and edited."""
