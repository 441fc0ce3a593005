"""Joint motion and forward kinematics of a chain, for one pose or many."""
