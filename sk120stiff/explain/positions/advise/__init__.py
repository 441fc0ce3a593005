"""What positions could not have shown, and the poses that would."""
