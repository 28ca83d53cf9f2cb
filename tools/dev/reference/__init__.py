"""Pages of docs/reference, made of the tables of the code."""
