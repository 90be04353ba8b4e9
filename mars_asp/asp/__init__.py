"""An engine for explained answer sets: it reads rules, grounds and solves them, and says why."""
