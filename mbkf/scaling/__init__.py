"""Fitting the body to a person: scale factors, marker positions, and their correction on a trial."""
