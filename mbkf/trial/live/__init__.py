"""The filter on a live stream: steps, names of points, scaling, the log and the results made of it."""
