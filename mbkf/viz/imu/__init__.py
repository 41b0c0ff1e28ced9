"""Figures of inertial measurements."""
