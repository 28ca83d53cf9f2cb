"""Parts of tools/test: entries, tiers, expected times, the choice after a change, and the run."""
