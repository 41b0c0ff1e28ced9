"""The torque-state filter of the thesis: plant, noise, integrators, settings, start and smoother."""
