r"""Where a model fails, which effect is missing, and the loop that adds it."""
