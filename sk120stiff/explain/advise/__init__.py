"""What follows: the smallest sizes that would have shown, the best guess, what to measure next."""
