"""What stands behind tools/run, demo, test, campaign, bench and plot."""
