"""Which set of effects explains the gap best: scores, a beam over sets, stepwise selection."""
