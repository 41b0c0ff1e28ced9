"""Long trials reconstructed in pieces: memory does not grow with them, and the result is written as it goes."""
