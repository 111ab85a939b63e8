"""Print servers: what to ask of them and what their answers mean; no I/O.

requests    requests and answers as values; a dialogue yields the one and is sent the other
octoprint   OctoPrint
moonraker   Moonraker, which serves Klipper
prusalink   PrusaLink, on a computer beside a printer or in Prusa's firmware
kinds       the three by name
"""
