"""Which segment and landmark each marker of an unknown capture is on, from names, standing body and movement."""
