"""One question of a user per file: scale, reconstruct, synthesise, describe, export."""
