"""A trial prepared for a filter: its inputs, and the chosen filter built from them."""
