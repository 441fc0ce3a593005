"""A measuring campaign under way: what is known, which reading comes next, and when to stop."""
