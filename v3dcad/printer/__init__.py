"""Printing: protocols without I/O, and what carries them.

Without I/O; the clock comes in as a number:
lines          G-code lines with number and checksum
replies        what printers say
handshake      the first words: which firmware, does it check numbers
patience       how long a printer is waited for
sender         each line once and in order, whatever is lost on the way
job            a print: pause, cancel, overrides, a proven end
progress       what a print is made of, and how far it is
machine_state  where a printer stands, its modes and heat
resume         where a print that was broken off goes on
fit            whether a file fits a machine
ends           how a print, or an upload, can end
settings       options of port and print server
hosts/         dialogues with print servers

With I/O:
program        the file that is printed
journal        how far a print is, kept on disk
serial_link    ports; the only file that imports serial
drive          clock and port for handshakes and jobs
http_link      print servers; the only file that imports an HTTP library
sending        one file to one print server, whole or not at all
address_book   printers by name, and their keys
"""
