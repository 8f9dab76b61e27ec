"""Lets drives happen, in virtual time, and writes down what was observed."""
