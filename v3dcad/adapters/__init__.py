"""v3dcad at home in other CAD libraries: one thin file for each, all over the same `fill()`."""
