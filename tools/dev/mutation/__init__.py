"""Faults put into the firmware on purpose: where one can be put, how it is built in, which tests could notice it."""
