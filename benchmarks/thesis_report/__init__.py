"""What a study of the thesis reports: bounded numbers, verdicts on its claims, tables and figures, on one page."""
