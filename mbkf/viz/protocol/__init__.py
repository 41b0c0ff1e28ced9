"""Pages of marker sets: one that shows a set, one that edits it."""
