"""Solutions in closed form, for tests and benchmarks."""
