"""The verdict on a trial: evidence as numbers, and a pure function of it that says which results may be used."""
