"""The least-squares problem, its solution within bounds, and what its derivative says."""
