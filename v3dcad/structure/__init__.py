"""The method: sites, their growth, and the layers they make of a part's sections.

growth and births say who grows; layers is the compiled loop and course what surrounds it; fill is
what users hold, and walls what its layers are slices of.
"""
