"""A session's captures before anything is computed: their kind, their content and their problems."""
