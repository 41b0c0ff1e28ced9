"""Gait events and gait cycles of a reconstruction."""
