"""Where model and readings disagree: poses, loads, directions, joints, order."""
