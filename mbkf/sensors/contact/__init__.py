"""Foot contact: which foot stands on which plate, on the floor or on nothing; causally and offline."""
