"""What may be missing: the whole catalogue as one linear regression, and what stands for what."""
