"""Qualisys QTM's real-time protocol: packets, parameters, client and source."""
