"""Lab Streaming Layer: format, player, source and results."""
