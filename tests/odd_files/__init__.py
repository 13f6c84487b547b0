"""Files as loggers, scopes, spreadsheets and controllers write them: one good record, dressed at random with a seed.

`good` makes the record without the package, `draft` writes it, the modules `*_kinds` each know one way of being odd and what a
command must make of it, `draw` combines them, `judge` runs the commands and compares. As a program it prints a table:

    python -m tests.odd_files [--full] [--count 150] [--seed 0] [--kind TEXT] [--keep FOLDER]

Nothing here knows how the package reads a file: what is right follows from what a person would type after reading the README.
"""
