"""Causes that a calibration leaves out: which, how each would show, what it does to the rest."""
