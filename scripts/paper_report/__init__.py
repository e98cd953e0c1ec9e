"""Parts of scripts/reproduce: one module for each group of the papers' experiments."""
