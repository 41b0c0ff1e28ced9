"""The dynamic filter: plant, settings, standard blocks, start and smoother."""
