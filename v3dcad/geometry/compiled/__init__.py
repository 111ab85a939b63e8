"""The one door to numba: how functions are compiled, linked and cached, and the types they take.

options     the decorator `compiled`, and the options for each kind of function
linked      the decorator `linked`: functions that compiled code calls by name
signatures  numba's signatures, read from annotations
arrays      the annotations of arrays
records     records of whole numbers with named fields
intrinsics  sums in 128 bits, room on the stack
speed       compiling made quicker
cache       where compiled code is kept; that of older sources is deleted
"""
