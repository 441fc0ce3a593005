"""What an instrument saw: where it stood, which marker, orientations, and what changed between."""
