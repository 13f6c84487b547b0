"""What a record says of parameters and laws by regression along its measured motion, without simulation.

Fast, never lost, and biased by the noise of the motion: it gives starts and shapes, and the fits of `jaxbacklash.fitting` decide.
"""
