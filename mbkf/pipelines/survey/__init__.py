"""What a session's captures are, and what is wrong with them, before anything is computed from them."""
