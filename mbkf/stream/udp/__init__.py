"""JSON lines over UDP: the protocol's messages, player and source."""
