"""One trial: a question of the user per file here, from a capture to a result; the parts of the answers in folders."""
