"""The report of a session: cycles of several trials with their means, norms, and two sessions compared."""
