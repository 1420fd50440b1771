"""Forms: typing into boxes, and boxes that show and change what elements are."""
