"""Pictures and the page.

Import the file you need: figures bring matplotlib, for which ``--json`` alone should not wait.
"""
