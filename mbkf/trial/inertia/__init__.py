"""Segment masses and centres of mass from plates: prior, both sides of Newton's law over trials, posterior."""
