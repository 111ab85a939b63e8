"""The only folder that imports OCP: reading, sectioning and writing B-rep."""
