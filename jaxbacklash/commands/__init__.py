"""What each command of the command line does; `jaxbacklash.cli` only declares them."""
