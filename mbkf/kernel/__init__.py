"""Compiled arithmetic of a filter's step, where it was built; by numpy and Pinocchio the same elsewhere."""
