"""Which measured point is which marker: the first frame by geometry, then frame by frame by prediction."""
