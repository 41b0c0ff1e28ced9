"""Whether two source trees give the same results, capture by capture; see ``benchmarks.equality.__main__``."""
