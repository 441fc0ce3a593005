"""How probable a name is, by which law it acts, what it takes off, and what is left."""
