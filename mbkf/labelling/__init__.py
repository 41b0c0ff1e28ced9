"""Labels of measured points: the first frame by geometry, then frame by frame by prediction."""
