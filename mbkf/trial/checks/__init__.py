"""Checks of a capture that stand apart from what a filter forces: mass, plates, clocks, floor and markers."""
