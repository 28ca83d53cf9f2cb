"""tools/commission: guided start-up of a plant over the console (docs/use/commission.md)."""
