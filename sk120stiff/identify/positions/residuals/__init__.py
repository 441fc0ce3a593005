"""What a calibration leaves: pure error, what is left beyond it, and along which line it lies."""
