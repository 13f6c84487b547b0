"""Bad input, drawn at random with a seed, over all commands: records, models, laws, options, stores, caches, signals.

`case` says what a case is, the modules named after doors each draw cases, `run` runs one (within a warm worker, or in a process
of its own where the process is what is tested), `verdict` judges: exit code 2 or 1 with one sentence, or a right answer; no
traceback, no hang, no file lost or changed, none half written. As a program it prints a table by kind:

    python -m tests.fuzz [--count 500] [--seed 0] [--kind TEXT] [--workers 1]
"""
