"""Which marker set a person's captures wear: a shipped protocol, or one inferred from them."""
