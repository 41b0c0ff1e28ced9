"""What people look at: the 3-D scene, the live page, playback and the report."""
