"""What may be missing where positions were read, to first order, and which of it they ask for."""
