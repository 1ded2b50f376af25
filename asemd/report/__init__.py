"""Error against run time: what a scene's settings cost, and what they are worth."""
