"""Many trials of one person or of many: batches, sessions, surveys of folders, and tuned settings."""
