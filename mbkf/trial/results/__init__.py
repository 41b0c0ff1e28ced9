"""The result of a tracked trial: clinical angles, reactions and torques, summary, errors against truth."""
