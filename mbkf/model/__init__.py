"""The body: reference description, scaling, protocols, clinical angles; the only door to Pinocchio."""
