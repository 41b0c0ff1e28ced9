"""Are up, right and left of a capture those of the person in it? Evidence, decision and what follows from it."""
