"""How long tests wait for a real browser, and for what."""

import time

PATIENCE_S = 120.0


def until(page, expression):
    """Waits for something to become true in the page (whose policy forbids playwright's own way of waiting)."""
    ends = time.monotonic() + PATIENCE_S
    while not page.evaluate(expression):
        assert time.monotonic() < ends, f"never true: {expression}"
        page.wait_for_timeout(30)
