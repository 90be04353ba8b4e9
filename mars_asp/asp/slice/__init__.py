"""Which rules, and which of their instances, a question can need, and what keeps parts apart."""
