"""Files of inertial sensors: one reader a form, each of which makes the same record."""
