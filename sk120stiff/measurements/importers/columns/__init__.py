"""What columns of a table mean: words of their headers, and words in their cells."""
