"""The MARS model decided by rules: facts, analysis, synthesis, verification and questions."""
