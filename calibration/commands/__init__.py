"""The commands of the command line, one a file.

What a file imports at its top every command pays for, so each imports the rest when it runs.
"""
