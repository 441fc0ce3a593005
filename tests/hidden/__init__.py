"""The sealed hidden-effect benchmark: make cases, run the public command, score its answers."""
