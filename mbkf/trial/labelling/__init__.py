"""The parts of labelling: the search, one pass through time, offline decisions, doubts, score and files."""
