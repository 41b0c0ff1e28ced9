"""The 3-D scene: description, body shapes, rows to draw, recording and playback."""
