"""Results sent on to other programs while a run goes on."""
