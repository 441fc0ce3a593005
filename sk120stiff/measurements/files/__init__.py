"""Files become `Measurements`, and `Measurements` become files."""
