"""OptiTrack NatNet: packets, player and source."""
