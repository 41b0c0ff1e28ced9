"""Electromyograms of a trial: channels by their names, envelopes, and the times in which muscles are active."""
