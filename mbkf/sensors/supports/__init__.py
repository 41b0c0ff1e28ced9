"""Other contacts than the feet's: a seat, a knee or a hand on the floor, a rail, a load in the hands."""
