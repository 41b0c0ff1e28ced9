"""Coordination of unobserved limbs with trunk and legs: the prior, and the regression behind it."""
