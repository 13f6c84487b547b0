"""The best a user of other tools could do on the same task, to be measured beside the package."""
