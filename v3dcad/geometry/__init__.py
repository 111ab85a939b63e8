"""Numbers in, numbers out: plane geometry on numpy arrays; knows no layer, part or file."""
