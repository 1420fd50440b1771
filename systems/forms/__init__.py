"""Forms: typing into boxes, and boxes that show and change the Fields of elements."""
