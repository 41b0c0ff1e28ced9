"""Inference of marker sets: segments and landmarks of unknown markers, from names, a posed body and movement."""
