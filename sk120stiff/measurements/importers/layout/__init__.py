"""Where in a file the table is: rows of headers, rows without, rows in which nothing was read."""
