"""What stands behind the commands of tools/."""
