"""Fork processes, watch them, start them again, and end them in the right order.

It imports nothing else of Kompass.
"""
