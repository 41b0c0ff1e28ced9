"""Coordination of limbs that nothing observes with trunk and legs: the prior, and the regression behind it."""
