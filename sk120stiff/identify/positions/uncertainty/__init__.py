"""What makes the values of a calibration more uncertain than the noise does."""
