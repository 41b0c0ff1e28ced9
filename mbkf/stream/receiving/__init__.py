"""From a source to the filter: the reading thread, frame numbers, plate samples, alignment, ring buffer."""
