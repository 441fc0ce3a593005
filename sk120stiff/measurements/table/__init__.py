"""A CSV file and the YAML file beside it as text that knows its line: columns, rows, settings."""
