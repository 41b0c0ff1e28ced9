"""Files to immutable records and back: the only room that converts units and axes."""
