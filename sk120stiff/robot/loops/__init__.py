"""Closed loops: dependent joints follow because two frames must coincide."""
