"""Commands for those who change this project: tests, style, faults put in, images, speed."""
