"""What each target of a preview shows: one place for pictures, page and workbench.

`declared` names the targets and what they ask for, `shown` says what a preview is made of;
`one_layer`, `whole` and `toolpath` make what a target shows, `sizes` measures cells over height;
`preview` is the door to them all.
"""
