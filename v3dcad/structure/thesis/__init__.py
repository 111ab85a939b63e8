"""The thesis's own method, Algorithms 1, 2 and 5 to 8 as written, for reproduction.

| file | algorithm |
|---|---|
| `loop.py` | 1, the layer loop, and the values that it hands out |
| `state.py` | what the loop carries from layer to layer |
| `tree.py` | the order in which the spanning tree is walked |
| `cells.py` | cells as polygons; 4, distinct points |
| `proximity.py` | 2, which points lie on the section's boundary |
| `insert.py` | 5 and 6, where a new site goes |
| `settle.py` | 7, the smallest weights that keep inserted cells |
| `inset.py` | 8, inserted cells drawn in |

Where the thesis is silent or contradicts itself, `docs/thesis.md` says how it was read.
"""
