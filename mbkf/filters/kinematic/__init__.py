"""The kinematic filter: plant, settings, start and smoother; torques afterwards by inverse dynamics."""
