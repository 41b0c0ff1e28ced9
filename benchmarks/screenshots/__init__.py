"""The pictures of pages and reports in README and docs: ``python -m benchmarks.screenshots`` takes them all."""
