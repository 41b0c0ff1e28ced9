"""Many trials: each person scaled once, every trial reconstructed in a folder of its own, tables over all of them."""
