"""Which of the selected effects may be named, and what is left: evidence, other poses, adequacy."""
