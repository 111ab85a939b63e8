"""G-code: toolpaths written, files of any slicer read, machine profiles, thesis's templates.

writer           a toolpath to a file: header, progress, moves
moves            words of steps
lines            text of words, compiled
blocks           header, start and end blocks
reader           what a G-code file does
machine_profile  profiles of machines, read from TOML
template         header and footer of an example file (Algorithm 12)
path_adjustment  the thesis's path adjustment (Algorithm 13)
"""
