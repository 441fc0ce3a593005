"""What a fit is held against: noise, repeats, other poses, other models, what was not seen."""
