"""The report on a reconstruction, one section per file."""
