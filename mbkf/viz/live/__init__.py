"""The pages of a live run."""
