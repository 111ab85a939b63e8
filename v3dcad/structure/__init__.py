"""The method: sites, their growth, and the layers they make of a part's sections."""
