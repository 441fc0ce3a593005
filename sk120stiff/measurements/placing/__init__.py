"""Where the instrument stands: readings laid onto the rigid robot, and slips that this shows."""
