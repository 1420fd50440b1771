"""What happens among driven particles in a step, between the calls of the step program that moves them."""
