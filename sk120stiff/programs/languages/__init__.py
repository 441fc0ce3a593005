"""Robot languages, one a file."""
