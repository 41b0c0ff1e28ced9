"""A trial prepared for a filter: its markers and names, its settings, its inputs, and the chosen filter."""
