"""The one door to numba: how functions are compiled, linked and cached, and the types they take.

options  what numba is asked for        linked  functions that compiled code calls by name
arrays   types of arrays and numbers    speed   compiling made quicker
cache    caches of other sources, thrown away
"""
