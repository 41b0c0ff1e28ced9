"""The laboratory's page: a session's folder becomes a checked report in the browser of this computer."""
