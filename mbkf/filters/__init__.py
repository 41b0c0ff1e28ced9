"""Filters on the body: a plant that predicts, sensor blocks that correct, one update for all."""
