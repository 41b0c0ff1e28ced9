"""Checks of a capture that do not rest on a filter: mass, plates, clocks, floor and markers."""
