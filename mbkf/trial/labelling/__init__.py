"""Parts of labelling: starts, passes through time, offline relabelling, doubts, score and files."""
