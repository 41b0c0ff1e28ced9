"""Scaling from a session: a person's standing trial and those of the other trials that show the body well."""
