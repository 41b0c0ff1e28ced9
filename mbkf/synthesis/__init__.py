"""Synthetic captures with exact truth: motions of the body that obey Newton's law, and what a laboratory measures of them."""
