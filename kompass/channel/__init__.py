"""The channel between the monitor and each process of components that one supervisor forked.

A pair of connected sockets for each process, made before the forks: who was forked with an end can
speak on it, and nobody else. So nothing on it is signed; the kernel is the proof. The supervisor
keeps both ends, so that a channel outlasts the processes at its ends, and reads nothing of it.
"""
