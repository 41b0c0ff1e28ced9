"""One live run: connecting, scaling a standing person, filtering, logging, reporting."""
