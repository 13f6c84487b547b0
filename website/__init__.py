"""The documentation site: what is made from the package, the build, and the check of its links. ``python -m website``."""
