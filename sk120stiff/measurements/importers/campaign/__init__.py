"""Several files of one campaign: one after the other, or each row with its row of another."""
