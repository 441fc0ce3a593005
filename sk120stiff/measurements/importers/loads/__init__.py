"""What pressed on the robot: forces, hung masses, poses read without load and with it."""
