"""Of an attempt as a whole: balance, errors, the ledger, what is kept and what is recorded."""
