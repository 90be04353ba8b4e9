"""Mutation: small changes of the rules and of the Python that judges, which tests must notice.

    python -m tests.mutate [--rules FILE...] [--python FILE...] [--sample N] [--list-survivors]

Mutants are made from syntax trees, never from text. A mutant that no test notices *survives*: it is
equivalent, and listed with the reason in `tests/mutants.toml`, or a case is missing.
"""
