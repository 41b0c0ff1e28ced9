"""A result in the coordinates of another person's or laboratory's OpenSim model."""
