"""A gate against regression: numbers of short runs from end to end, held against a committed baseline."""
