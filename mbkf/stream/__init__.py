"""Live streams: sources of frames (LSL, NatNet, files), replay of captures, results out."""
