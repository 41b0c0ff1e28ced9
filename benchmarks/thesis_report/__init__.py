"""Reports of studies that redo a source: bounded numbers, verdicts on claims, tables and figures, on one page."""
