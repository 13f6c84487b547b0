"""A page to work in, on this machine alone: from a file to the effect that a model lacks, and the Python that repeats it.

The work and the page are apart. `session` holds the work: the record, the tree of models with undo and branches, what is being
computed. It knows no browser, and may be used without one. `page` shows it and hands on what is pressed; `guard` and `serving`
let the page's owner in and nobody else. Long work runs in a process of its own (`worker`), so that it can be stopped.
"""
