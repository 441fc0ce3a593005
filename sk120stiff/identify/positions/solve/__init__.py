"""The least-squares problem of positions, where it starts, and how it is solved."""
