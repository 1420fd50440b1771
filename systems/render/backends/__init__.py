"""What draws marks: in a window, as PNG, SVG and PDF."""
