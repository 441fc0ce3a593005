"""Independent references for the tests. Nothing here imports the product or Pinocchio."""
