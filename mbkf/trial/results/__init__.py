"""What a tracked trial becomes: clinical angles, reactions and torques, summary, errors against truth."""
