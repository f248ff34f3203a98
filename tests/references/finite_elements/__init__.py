"""Full finite element solutions of contacts, without modes."""
