"""Campaigns and studies. Nothing of `reflux` imports from here."""
