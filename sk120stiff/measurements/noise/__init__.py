"""The noise of readings: its law, what repeats say of it, and whitening by it."""
