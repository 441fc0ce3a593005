"""How sure a fitted model is: likelihood intervals, model-form error, what it predicts."""
