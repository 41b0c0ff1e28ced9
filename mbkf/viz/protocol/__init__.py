"""Pages of marker sets: one to look at, one to change a set on."""
