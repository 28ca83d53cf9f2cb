"""What tools/test is made of: entries, tiers, expected times, the choice after a change, and the run."""
