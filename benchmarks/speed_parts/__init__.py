"""What `benchmarks.speed` measures, a file for each part of the way."""
