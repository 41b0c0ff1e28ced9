"""Reports of studies that redo a source text: bounded numbers, verdicts on its claims, tables and figures, on one page."""
