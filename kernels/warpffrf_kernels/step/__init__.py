"""The attempt as a whole: balance, errors, energy ledger, acceptance and recording."""
