"""Loads of a trial as a whole: whether the contacts explain how the centre of mass moves."""
