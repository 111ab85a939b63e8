"""v3dcad behind lines of JSON: a child process of a program that shows what it makes.

`python -m v3dcad.worker FOLDER`; docs/worker.md has the protocol. It computes nothing of its own.

loop          lines in, answers and errors in words out
requests      what each request does
declarations  settings as they are told, and as they come back
kept          the part, its sections and the structure of the last requests
arrays        the files that answers name
parent        the end with the parent
"""
