"""The trials of a session together: cycles and their means, jumps, squats, norms, and two sessions compared."""
