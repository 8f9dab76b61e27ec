"""Requests that prove who made them: keys, challenges and proofs. No ROS, clock or files.

A node that takes requests gives out a challenge, a random word that it exchanges every minute. Who
has the robot's key makes a proof for a request: HMAC-SHA256 over the name of the service, every
field of the request (author and role among them), the challenge and a random word of its own. The
node believes a proof once, and only while its challenge counts. No clock is compared with
another's, and what was overheard is worth nothing a second time, nor after a restart.
"""
