"""The package behind the commands of tools/."""
